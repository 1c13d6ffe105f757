"""Short-term, working and long-term memory: what stays in RAM, and why."""
