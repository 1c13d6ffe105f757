"""``slamdeck info --diff``: parameters of map files side by side."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import typer


def parameter_diff(paths: Sequence[Path], *, as_json: bool) -> None:
    """Print the parameters that two files, or one and the defaults, do not agree on."""
    from rich.console import Console
    from rich.table import Table

    from slam.database import MapReader
    from slam.tools.parameters import differences

    found = differences(*(MapReader(path).parameters() for path in paths))
    if as_json:
        typer.echo(json.dumps({"files": [str(path) for path in paths], "differences": [asdict(one) for one in found]}))
        return
    if not found:
        typer.echo("no parameter differs")
        return
    table = Table(box=None, padding=(0, 2, 0, 0))
    for title in ("parameter", *(path.name for path in paths), "default", "RTAB-Map"):
        table.add_column(title, overflow="fold")
    for one in found:
        table.add_row(one.name, *(_shown(value) for value in (*one.values, one.default, one.rtabmap)))
    Console().print(table)


def _shown(value: str | None) -> str:
    return "-" if value is None else value or '""'
