"""What is done to whole map files: replay, repair, thin, compare."""
