"""The commands of ``slamdeck``; each imports what is heavy only when it runs."""

from __future__ import annotations

from typing import Annotated

import typer

from server.cli.demo import demo
from server.cli.export import export
from server.cli.info import info
from server.cli.params import params
from server.cli.run import run
from server.cli.serve import serve

app = typer.Typer(
    name="slamdeck",
    help="RGB-D SLAM in RTAB-Map's tradition, with a dashboard: map, watch, inspect, correct.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


@app.callback()
def options(
    version: Annotated[bool, typer.Option("--version", help="Print the version and end.", is_eager=True)] = False,
) -> None:
    """RGB-D SLAM in RTAB-Map's tradition, with a dashboard: map, watch, inspect, correct."""
    if version:
        from importlib.metadata import version as installed_version

        typer.echo(f"slamdeck {installed_version('slamdeck')}")
        raise typer.Exit


for command in (demo, run, serve, info, export, params):
    app.command()(command)
