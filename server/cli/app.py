"""The commands of ``slamdeck``; each imports what is heavy only when it runs."""

from __future__ import annotations

from typing import Annotated

import typer

from server.cli.demo import demo
from server.cli.edits import detect, refine, regrid
from server.cli.export import export
from server.cli.info import info
from server.cli.merge import merge
from server.cli.params import params
from server.cli.poses import optimize, turn
from server.cli.recover import recover
from server.cli.reprocess import reprocess
from server.cli.run import run
from server.cli.serve import serve
from server.cli.trial import try_parameters

app = typer.Typer(
    name="slamdeck",
    help="RGB-D SLAM in RTAB-Map's tradition, with a dashboard: map, watch, inspect, correct.",
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def show_version(asked: bool) -> None:
    """Print the version and end."""
    if asked:
        from importlib.metadata import version

        typer.echo(f"slamdeck {version('slamdeck')}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=show_version, is_eager=True, help="Print the version and end.")
    ] = False,
) -> None:
    """RGB-D SLAM in RTAB-Map's tradition, with a dashboard: map, watch, inspect, correct."""


for command in (
    demo,
    run,
    serve,
    info,
    reprocess,
    merge,
    recover,
    detect,
    refine,
    regrid,
    optimize,
    turn,
    export,
    params,
):
    app.command()(command)
app.command("try")(try_parameters)
