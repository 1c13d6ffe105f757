"""The API, one resource in one file."""
