"""The engine in a process of its own: what goes in, what comes out, both ends of the channel."""
