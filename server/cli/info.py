"""``slamdeck info``: what a map file holds."""

from __future__ import annotations

import json as json_format
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from slam.database import MapReader


def info(
    path: Annotated[Path, typer.Argument(metavar="FILE", help="A map file of slamdeck or RTAB-Map.")],
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Version, nodes, links, words, sizes, parameters that differ from the defaults, and each session."""
    from rich.console import Console
    from rich.table import Table

    from server.browse.summary import facts
    from slam.database import MapReader

    reader = MapReader(path)
    found, sessions = facts(reader.info()), _sessions(reader)
    if json:
        typer.echo(json_format.dumps({**found.model_dump(), "session_list": sessions}))
        return
    table = Table(show_header=False, box=None, padding=(0, 2, 0, 0))
    for name, value in found.model_dump().items():
        table.add_row(name.replace("_", " "), _text(name, value))
    for session in sessions:
        table.add_row(f"session {session['map_id']}", _session_text(session))
    Console().print(table)


def _sessions(reader: MapReader) -> list[dict[str, Any]]:
    from server.browse.sessions import session_list

    return [session.model_dump() for session in session_list(reader, reader.nodes(), reader.links())]


def _session_text(session: dict[str, Any]) -> str:
    joined = ", ".join(map(str, session["joined_with"]))
    parts = [f"{session['nodes']} nodes", session["source"], f"one map with {joined}" if joined else "on its own"]
    return ", ".join(part for part in [*parts, "" if session["clean"] else "not closed in order"] if part)


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
