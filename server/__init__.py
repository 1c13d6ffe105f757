"""The server: FastAPI, the engine worker, the viser scene and the command line."""
