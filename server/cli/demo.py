"""``slamdeck demo``: a rendered flat, mapped live."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Annotated

import typer

from server.cli.live import run_live
from server.cli.options import (
    PORT,
    ConfigOption,
    HostOption,
    NameOption,
    NoTokenOption,
    ParamOption,
    PortOption,
    SeedOption,
    TokenOption,
    parameters,
)
from server.cli.serve import settings_of


def demo(
    db: Annotated[Path | None, typer.Option(help="Map file to make; without it, one in a temporary folder.")] = None,
    source: Annotated[str, typer.Option(help="What to map: tour: with options, or a TUM folder.")] = "tour:",
    speed: Annotated[float, typer.Option(min=0, max=100, help="Times real time; 0 is as fast as possible.")] = 1.0,
    param: ParamOption = None,
    config: ConfigOption = None,
    seed: SeedOption = 0,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a map file that is there.")] = False,
    host: HostOption = "127.0.0.1",
    port: PortOption = PORT,
    token: TokenOption = None,
    no_token: NoTokenOption = False,
    name: NameOption = None,
) -> None:
    """Map a rendered tour of two rounds through a flat while you watch; prints the address of the page."""
    path = db or Path(tempfile.mkdtemp(prefix="slamdeck-")) / "tour.db"
    roots = [path if db is not None else path.parent]
    settings = settings_of(roots, [], host, port, token, no_token, name)
    values = parameters(config, param)
    run_live(settings, source, path, values, seed=seed, speed=speed, overwrite=overwrite, note=f"mapping into {path}")
