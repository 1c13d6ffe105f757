"""Who may talk to the server, and what its pages may do."""
