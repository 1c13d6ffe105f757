"""``slamdeck reprocess``: map files again, with other parameters."""

from __future__ import annotations

import json as json_format
from collections.abc import Callable
from contextlib import ExitStack
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from server.cli.options import ConfigOption, ForceOption, JsonOption, ParamOption, SeedOption, parameters


class Whose(StrEnum):
    """What is stored in the file, or our own."""

    STORED = "stored"
    OWN = "own"


def reprocess(
    inputs: Annotated[list[Path], typer.Argument(metavar="FILE...", help="Map files; each begins a new session.")],
    db: Annotated[Path, typer.Option(help="Map file to make.")],
    param: ParamOption = None,
    config: ConfigOption = None,
    odometry: Annotated[
        Whose, typer.Option(help="Odometry poses and covariances of the files, or tracked on their images.")
    ] = Whose.STORED,
    features: Annotated[
        Whose | None,
        typer.Option(help="Key points of the files, or found anew; without it anew where a parameter asks for others."),
    ] = None,
    seed: SeedOption = 0,
    force: ForceOption = False,
    json: JsonOption = False,
) -> None:
    """Map the nodes of one or several files again: loops anew, links and decisions by hand kept, into a new file.

    Parameters are those of the first file, but for what is set here. Every node stays one: RGBD/LinearUpdate,
    RGBD/AngularUpdate and Rtabmap/DetectionRate count only where they are set here.
    """
    from slam.tools import reprocess as tool

    request = tool.Request(
        inputs=inputs,
        output=db,
        changes=parameters(config, param),
        odometry=tool.Whose(odometry),
        features=None if features is None else tool.Whose(features),
        seed=seed,
        force=force,
    )
    show(run_with_bar(tool.reprocess, request), db, as_json=json)


def run_with_bar(carry_out: Callable[..., dict[str, Any]], request: Any) -> dict[str, Any]:
    """Carry out a replay with a progress bar on stderr."""
    from server.cli.progress import progress
    from slam.run import Tally
    from slam.types import Update

    with ExitStack() as stack:
        bars: list[Any] = []

        def advance(update: Update, tally: Tally, frames: int) -> None:
            if not bars:
                bars.append(stack.enter_context(progress("mapping again", frames)))
            bars[0](update, tally)

        return carry_out(request, advance)


def show(summary: dict[str, Any], path: Path, *, as_json: bool) -> None:
    """Print what came of it."""
    if as_json:
        typer.echo(json_format.dumps(summary))
        return
    from rich.console import Console

    from server.cli.summary_table import summary_table

    table, by_hand = summary_table(summary, path), summary["by_hand"]
    table.add_row("taken over", f"{summary['replayed']} nodes, {summary['features']} features")
    kept = f"{by_hand['decisions']} decisions, {by_hand['links']} of them links, {by_hand['labels']} labels"
    table.add_row("by hand", kept)
    for name in ("lost", "unreadable_images", "not_optimized"):
        for text in summary[name]:
            table.add_row(name.replace("_", " "), text)
    for text in summary["refused_parameters"].values():
        table.add_row("not followed", text)
    Console().print(table)
