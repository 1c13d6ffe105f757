"""``slamdeck info``: what a map file holds."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from server.cli.options import Json

if TYPE_CHECKING:
    from slam.database import MapInfo


def info(
    db: Annotated[Path, typer.Argument(help="Map file (.db) of slamdeck or RTAB-Map.")],
    json_: Json = False,
) -> None:
    """Say what a map file holds; the file isn't changed."""
    from slam.database import MapReader

    found = describe(MapReader(db).info())
    if json_:
        print(json.dumps(found))
        return
    for name, value in found.items():
        if isinstance(value, dict):
            print(f"{name}:")
            for key, entry in value.items():
                print(f"  {key:<34} {entry}")
        else:
            shown = ", ".join(map(str, value)) if isinstance(value, list) else value
            print(f"{name:<18} {'-' if shown in (None, '') else shown}")


def describe(found: MapInfo) -> dict[str, Any]:
    """The object that ``info --json`` prints; sizes in bytes, stamps in seconds."""
    return {
        "path": str(found.path),
        "version": found.version,
        "sessions": found.sessions,
        "nodes": found.nodes,
        "dropped": found.dropped,
        "links": dict(found.links),
        "words": found.words,
        "features": found.features,
        "size_bytes": found.size_bytes,
        "bytes_by_kind": dict(found.bytes_by_kind),
        "first_stamp": found.first_stamp,
        "last_stamp": found.last_stamp,
        "optimized": found.has_poses,
        "clean": found.clean,
        "seeds": list(found.seeds),
        "sources": list(found.sources),
        "parameters": dict(found.parameters),
    }
