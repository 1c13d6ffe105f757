"""Starting the server from the command line."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from slam.params import Params


def serve_maps(paths: Sequence[Path], *, host: str, port: int, no_token: bool) -> None:
    """Serves map files until interrupted."""
    from server.launch import serve

    serve(paths, host=host, port=port, token=_token(no_token), announce=_announce)


def serve_run(
    source: str, db: Path, params: Params, seed: int, *, overwrite: bool, host: str, port: int, no_token: bool
) -> None:
    """Serves the folder of a new map while an engine makes it; goes on serving when the engine is done."""
    from server.launch import RunRequest, serve
    from slam.database import remove_map

    if overwrite:
        remove_map(db)
    run = RunRequest(source=source, db=db, params=params, seed=seed)
    serve([db.parent], host=host, port=port, token=_token(no_token), run=run, announce=_announce)


def _token(no_token: bool) -> str | None:
    import secrets

    return None if no_token else secrets.token_urlsafe(24)


def _announce(link: str) -> None:
    print(f"slamdeck is ready: {link}", flush=True)
