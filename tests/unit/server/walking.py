"""Asking a server for everything that it lists of a map."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import httpx

_PARTS = ("", "/graph", "/loops", "/decisions", "/statistic-names", "/parameters", "/preview.jpg")
_OF_NODES = ("", "/image", "/depth.png", "/features")
_CLOSELY = ("/pixel?x=0.5&y=0.5", "/scan.png", "/grid.png", "/pair/1")
_EXPORTS = ("tum", "kitti", "g2o")
#: What a refusal says; anything else is a failure of the server's own.
_REFUSED = {404, 409, 422}


@dataclass
class Walk:
    """What was answered: addresses that gave something, and the refusals of the others."""

    shown: list[str] = field(default_factory=list)
    refused: dict[str, dict[str, Any]] = field(default_factory=dict)


def walk(client: httpx.Client, map_id: str, *, matches: bool = False, closely: bool = False) -> Walk:
    """Ask for the map, and for all nodes, links and statistics that it lists; AssertionError when the server fails."""
    found, root = Walk(), f"/api/maps/{map_id}"
    assert _ask(client, "/api/maps", found) is not None
    parts = {part: _ask(client, root + part, found) for part in _PARTS}
    page = _ask(client, f"{root}/nodes?limit=500", found) or {"nodes": []}
    graph = parts["/graph"] or {"nodes": {"id": []}, "links": {"from": [], "to": []}}
    for node_id in {*graph["nodes"]["id"], *(row["id"] for row in page["nodes"])}:
        for part in (*_OF_NODES, *(_CLOSELY if closely else ())):
            _ask(client, f"{root}/nodes/{node_id}{part}", found)
        _ask(client, f"{root}/hypothesis/{node_id}", found)
    listed = [(row["from"], row["to"]) for row in (parts["/loops"] or {"loops": []})["loops"]]
    for a, b in {*zip(graph["links"]["from"], graph["links"]["to"], strict=True), *listed}:
        _ask(client, f"{root}/links/{a}/{b}", found)
        if matches:
            _ask(client, f"{root}/links/{a}/{b}/matches", found)
    names = (parts["/statistic-names"] or {"names": []})["names"]
    _ask(client, f"{root}/statistics", found, names=",".join(names)[:4000])
    for kind in _EXPORTS:
        _ask(client, f"{root}/export/poses", found, format=kind)
    if closely:
        for name in ("grid.zip", "cloud.ply"):
            _ask(client, f"{root}/export/{name}", found)
    return found


def _ask(client: httpx.Client, path: str, found: Walk, **query: str) -> Any:
    answer = client.get(path, params=query or None)
    is_json = answer.headers["content-type"].startswith("application/json")
    if answer.status_code == 200:
        found.shown.append(path)
        return answer.json() if is_json else answer.content
    assert answer.status_code in _REFUSED and is_json, f"{path}: {answer.status_code} {answer.text[:500]}"
    error = answer.json()["error"]
    assert error["code"] != "http_error" and error["message"] and "\n" not in error["message"], error
    found.refused[path] = error
    return None
