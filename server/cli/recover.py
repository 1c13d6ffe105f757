"""``slamdeck recover``: a sound map of a damaged file."""

from __future__ import annotations

import json as json_format
from pathlib import Path
from typing import Annotated, Any

import typer

from server.cli.options import ForceOption, JsonOption


def recover(
    path: Annotated[Path, typer.Argument(metavar="FILE", help="A map file that is damaged or was not closed.")],
    db: Annotated[Path, typer.Option(help="Map file to make.")],
    force: ForceOption = False,
    json: JsonOption = False,
) -> None:
    """Copy every row that can still be read, make the graph sound again, and tell what was lost."""
    from slam.tools.recover import recover as carry_out

    summary = carry_out(path, db, force=force)
    if json:
        typer.echo(json_format.dumps(summary))
        return
    for line in _lines(summary):
        typer.echo(line)


def _lines(summary: dict[str, Any]) -> list[str]:
    rows = ", ".join(f"{count} {table}" for table, count in summary["rows"].items())
    lines = [f"{summary['map']}: {rows}"]
    lost, mended = summary["lost"], summary["mended"]
    lines += [f"lost: {table} {text}" for table, texts in lost["pages"].items() for text in texts]
    lines += [f"lost of row: {table} {text}" for table, texts in lost["columns"].items() for text in texts]
    lines += [f"lost: {count} rows of {table} that can't be read" for table, count in lost["rows"].items()]
    lines += ["nothing was lost"] if summary["is_whole"] else []
    told = {
        "links got their reverse": mended["reversed"],
        "links were dropped": mended["dropped_links"],
        "gaps of odometry were bridged": mended["bridged"],
    }
    for what, pairs in told.items():
        if pairs:
            lines.append(f"{len(pairs)} {what}: {', '.join(f'{a}-{b}' for a, b in pairs)}")
    lines += [f"{count} rows of {table} belonged to lost nodes" for table, count in mended["dropped_rows"].items()]
    if mended["words"] or mended["lost_words"]:
        lines.append(f"{mended['words']} words were made again, {mended['lost_words']} are lost")
    lines += [f"the version was lost: {mended['version']} was given"] if mended["version"] else []
    lines += ["the parameters were lost: defaults were given"] if mended["parameters"] else []
    return [*lines, *summary["not_optimized"], *summary["still_missing"]]
