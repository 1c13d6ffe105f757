"""``slamdeck serve``: browse maps."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from server.cli.options import DEFAULT_HOST, DEFAULT_PORT, Host, NoToken, Port


def serve(
    paths: Annotated[list[Path], typer.Argument(help="Map files, or folders of map files.")],
    host: Host = DEFAULT_HOST,
    port: Port = DEFAULT_PORT,
    no_token: NoToken = False,
) -> None:
    """Browse and correct maps in the browser."""
    from server.cli.live import serve_maps

    serve_maps(paths, host=host, port=port, no_token=no_token)
