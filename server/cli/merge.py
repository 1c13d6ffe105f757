"""``slamdeck merge``: several map files as one map."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from server.cli.options import ConfigOption, ForceOption, JsonOption, ParamOption, SeedOption, parameters


def merge(
    inputs: Annotated[list[Path], typer.Argument(metavar="FILE FILE...", help="Map files, two or more.")],
    db: Annotated[Path, typer.Option(help="Map file to make.")],
    param: ParamOption = None,
    config: ConfigOption = None,
    seed: SeedOption = 0,
    force: ForceOption = False,
    json: JsonOption = False,
) -> None:
    """Make one map of several, joined by the loops between them; tells which joined, and why others did not."""
    from server.cli.reprocess import run_with_bar, show
    from slam.tools.merge import merge as carry_out
    from slam.tools.reprocess import Request

    request = Request(inputs=inputs, output=db, changes=parameters(config, param), seed=seed, force=force)
    summary = run_with_bar(carry_out, request)
    show(summary, db, as_json=json)
    if not json:
        for pair in summary["pairs"]:
            typer.echo(_told(pair))


def _told(pair: dict[str, Any]) -> str:
    first, second = pair["files"]
    if pair["joined"]:
        shown = ", ".join(f"{a}-{b}" for a, b in pair["links"][:5])
        return (
            f"{first} and {second} are one map: {len(pair['links'])} loops between them{': ' + shown if shown else ''}"
        )
    best = pair["best"]
    where = f"{best['from']}-{best['to']}: " if "from" in best else ""
    return f"{first} and {second} are not joined: {where}{best['text']}"
