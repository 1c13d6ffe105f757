"""``slamdeck demo``: a rendered room, mapped while one watches."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from server.cli.options import DEFAULT_HOST, DEFAULT_PORT, Config, Host, NoToken, Param, Port, Seed, read_params


def demo(
    source: Annotated[
        str, typer.Argument(help="TUM RGB-D folder, or tour:laps=2,... for the rendered tour.")
    ] = "tour:",
    db: Annotated[Path | None, typer.Option("--db", help="Map file to make; default: a new temporary one.")] = None,
    param: Param = None,
    config: Config = None,
    seed: Seed = 0,
    host: Host = DEFAULT_HOST,
    port: Port = DEFAULT_PORT,
    no_token: NoToken = False,
) -> None:
    """Map a rendered room of two laps, live in the browser."""
    from server.cli.live import serve_run

    params = read_params(config, param)
    serve_run(source, db or _new_file(), params, seed, overwrite=False, host=host, port=port, no_token=no_token)


def _new_file() -> Path:
    import tempfile

    return Path(tempfile.mkdtemp(prefix="slamdeck-")) / "demo.db"
