"""Options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from slam.errors import ParameterError
from slam.params import Params, Value
from slam.params.ini import known_unused, read_ini

ParamOption = Annotated[
    list[str] | None, typer.Option("--param", "-p", metavar="NAME=VALUE", help="Set a parameter, Rtabmap/LoopThr=0.15.")
]
ConfigOption = Annotated[
    Path | None, typer.Option("--config", metavar="FILE.ini", help="Parameters of RTAB-Map's .ini.")
]
SeedOption = Annotated[int, typer.Option(min=0, help="Seed of everything random.")]
HostOption = Annotated[str, typer.Option(help="Address to listen on; 0.0.0.0 lets other machines in.")]
PortOption = Annotated[int, typer.Option(min=0, max=65535, help="Port to listen on; 0 takes a free one.")]
NoTokenOption = Annotated[bool, typer.Option("--no-token", help="Let every user of this machine in (loopback only).")]
TokenOption = Annotated[
    str | None,
    typer.Option(envvar="SLAMDECK_TOKEN", show_envvar=True, help="Use this token instead of a random one."),
]
NameOption = Annotated[
    list[str] | None, typer.Option("--name", help="Another name under which the server is reached (reverse proxy).")
]
SourcesOption = Annotated[
    list[Path] | None, typer.Option("--sources", help="Folder whose sequences the page may have mapped.")
]

ForceOption = Annotated[bool, typer.Option("--force", help="Replace an output that is there.")]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]

PORT = 8700


def parameters(config: Path | None, given: list[str] | None) -> dict[str, Value]:
    """Values by name, those of the command line over those of the file; names that only RTAB-Map has are reported.

    Raises:
        ParameterError: a name is unknown, or a value is not one that it may have.
    """
    values: dict[str, Value] = {}
    unused: set[str] = set()
    if config is not None:
        file = read_ini(config)
        values.update(file.values)
        unused.update(file.unused)
    for text in given or []:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals:
            raise ParameterError(f"--param {text!r} has no value: write it as NAME=VALUE, Rtabmap/LoopThr=0.15")
        if known_unused(name):
            unused.add(name)
        else:
            values[name] = value
    Params().changed(values)
    if unused:
        typer.echo(f"parameters of RTAB-Map that slamdeck doesn't use: {', '.join(sorted(unused))}", err=True)
    return values
