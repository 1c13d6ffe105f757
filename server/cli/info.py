"""``slamdeck info``: what a map file holds."""

from __future__ import annotations

import json as json_format
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from server.cli.options import JsonOption
from slam.errors import DatabaseError

if TYPE_CHECKING:
    from slam.database import Faults, MapReader


#: Damaged rows that are listed one by one.
_MOST_FAULTS = 10

_UNITS = {"span_s": "s", "odometry_m": "m", "map_m": "m"}


def info(
    paths: Annotated[list[Path], typer.Argument(metavar="FILE...", help="A map file of slamdeck or RTAB-Map.")],
    json: JsonOption = False,
    diff: Annotated[
        bool, typer.Option("--diff", help="Compare the parameters of two files, or of one with the defaults.")
    ] = False,
) -> None:
    """Version, nodes, links, words, sizes, time, length, what is missing, parameters, and each session."""
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from server.browse.summary import facts
    from server.cli.parameter_diff import parameter_diff
    from slam.database import MapReader
    from slam.tools.describe import describe

    if len(paths) > (2 if diff else 1):
        few = "one or two map files" if diff else "one map file (two with --diff)"
        raise DatabaseError(f"{len(paths)} files are named: name {few}")
    if diff:
        parameter_diff(paths, as_json=json)
        return
    reader = MapReader(paths[0])
    faults: Faults = {}
    found, sessions = facts(reader.info(faults=faults)), _sessions(reader, faults)
    more = asdict(describe(reader, faults))
    if json:
        listed = [asdict(fault) for fault in faults]
        typer.echo(json_format.dumps({**found.model_dump(), **more, "session_list": sessions, "faults": listed}))
        return
    table = Table(show_header=False, box=None, padding=(0, 2, 0, 0))
    for name, value in {**found.model_dump(), **more}.items():
        table.add_row(name.replace("_", " "), _text(name, value))
    for session in sessions:
        table.add_row(f"session {session['map_id']}", _session_text(session))
    for fault in list(faults)[:_MOST_FAULTS]:
        table.add_row("makes no sense", escape(f"{fault.table}, row {fault.row}: {fault.reason}"))
    if len(faults) > _MOST_FAULTS:
        table.add_row("", f"and {len(faults) - _MOST_FAULTS} rows more")
    Console().print(table)


def _sessions(reader: MapReader, faults: Faults) -> list[dict[str, Any]]:
    from server.browse.sessions import session_list

    return [
        session.model_dump() for session in session_list(reader, reader.nodes(faults), reader.links(faults), faults)
    ]


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
    if name == "missing":
        return "\n".join(value) if isinstance(value, tuple) and value else "nothing"
    if name in _UNITS and isinstance(value, float):
        return f"{value:.2f} {_UNITS[name]}"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return _size(value) if name == "size_bytes" else str(value)


def _size(value: object) -> str:
    count = int(str(value))
    return f"{count / 1e6:.1f} MB" if count >= 100_000 else f"{count} bytes"
