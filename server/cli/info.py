"""``slamdeck info``: what a map file holds."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def info(
    path: Annotated[Path, typer.Argument(metavar="FILE", help="A map file of slamdeck or RTAB-Map.")],
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Version, sessions, nodes, links, words, sizes, and parameters that differ from the defaults."""
    from rich.console import Console
    from rich.table import Table

    from server.browse.summary import facts
    from slam.database import MapReader

    found = facts(MapReader(path).info())
    if json:
        typer.echo(found.model_dump_json())
        return
    table = Table(show_header=False, box=None, padding=(0, 2, 0, 0))
    for name, value in found.model_dump().items():
        table.add_row(name.replace("_", " "), _text(name, value))
    Console().print(table)


def _text(name: str, value: object) -> str:
    if isinstance(value, dict):
        parts = (f"{key} {_size(part) if name == 'bytes_by_kind' else part}" for key, part in value.items() if part)
        return ", ".join(parts) or "-"
    if isinstance(value, list):
        return ", ".join(map(str, value)) or "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return _size(value) if name == "size_bytes" else str(value)


def _size(value: object) -> str:
    count = int(str(value))
    return f"{count / 1e6:.1f} MB" if count >= 100_000 else f"{count} bytes"
