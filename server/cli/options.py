"""Options that several commands share."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from slam.errors import ParameterError
from slam.params import Params
from slam.params.ini import known_unused, read_ini

Param = Annotated[
    list[str] | None,
    typer.Option("--param", "-p", metavar="NAME=VALUE", help="Set a parameter, e.g. Rtabmap/LoopThr=0.15; repeatable."),
]
Config = Annotated[Path | None, typer.Option("--config", help="Parameters from a file of RTAB-Map (.ini).")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Seed of everything random.")]
Host = Annotated[str, typer.Option("--host", help="Address to listen at.")]
Port = Annotated[int, typer.Option("--port", min=0, max=65535, help="Port to listen at; 0 takes a free one.")]
NoToken = Annotated[bool, typer.Option("--no-token", help="Let in everybody on this machine (loopback only).")]

DEFAULT_HOST = "127.0.0.1"
DEFAULT_PORT = 8080


def read_params(config: Path | None, param: list[str] | None) -> Params:
    """Parameters of a file and of ``--param`` options, which win.

    Names that RTAB-Map has and slamdeck doesn't are said to be unused on standard error; all others must be known.
    """
    values: dict[str, str] = {}
    unused: list[str] = []
    if config is not None:
        file = read_ini(config)
        values.update(file.values)
        unused.extend(file.unused)
    for text in param or []:
        name, equals, value = text.partition("=")
        if not equals:
            raise ParameterError(f"--param {text!r}: must be NAME=VALUE, e.g. Rtabmap/LoopThr=0.15")
        if known_unused(name):
            unused.append(name)
        else:
            values[name] = value
    if unused:
        print(f"note: not used by slamdeck: {', '.join(sorted(unused))}", file=sys.stderr)
    return Params().changed(values)
