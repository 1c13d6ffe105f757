"""Which sessions of a map that was made of several files are one map now, and why others are not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

from slam.database import MapReader
from slam.errors import DatabaseError
from slam.graph.components import components
from slam.tools.reprocess import OnFrame, Request, reprocess
from slam.types import Candidate


def merge(request: Request, on_frame: OnFrame | None = None) -> dict[str, Any]:
    """Replay several files into one map; the summary of ``reprocess`` with the ``pairs`` of files.

    Each pair has the loops that join the two, whether they are one map (over a third one, too), and where they are not
    the best candidate with the test that refused it, its value and the threshold.

    Raises:
        SlamError: as ``reprocess``; or fewer than two files are named.
    """
    if len(request.inputs) < 2:
        raise DatabaseError(f"{len(request.inputs)} file is named: a merge needs two or more map files")
    summary = reprocess(replace(request, inputs=tuple(request.inputs)), on_frame)
    reader = MapReader(request.output)
    sessions: list[list[int]] = summary["sessions"]
    table = reader.nodes()
    map_id_of = dict(zip(table.ids.tolist(), table.map_ids.tolist(), strict=True))
    file_of = {map_id: file for file, of_file in enumerate(sessions) for map_id in of_file}
    links = [link for link in reader.links() if link.from_id in map_id_of and link.to_id in map_id_of]
    piece_of = components(file_of, ((map_id_of[link.from_id], map_id_of[link.to_id]) for link in links))
    names = [path.name for path in request.inputs]
    pairs = []
    for a, b in combinations(range(len(names)), 2):
        between = [
            (link.from_id, link.to_id)
            for link in links
            if {file_of[map_id_of[link.from_id]], file_of[map_id_of[link.to_id]]} == {a, b}
        ]
        joined = bool({piece_of[i] for i in sessions[a]} & {piece_of[i] for i in sessions[b]})
        pair: dict[str, Any] = {"files": [names[a], names[b]], "joined": joined, "links": sorted(between)}
        if not joined:
            pair["best"] = _best(reader, map_id_of, sessions[a], sessions[b])
        pairs.append(pair)
    return {**summary, "pairs": pairs}


def _best(reader: MapReader, map_id_of: dict[int, int], a: Sequence[int], b: Sequence[int]) -> dict[str, Any]:
    """The refused candidate between two files with most inliers, or else the best hypothesis."""
    tried = [
        row.candidate
        for row in reader.candidates()
        if _across(map_id_of, row.candidate.from_id, row.candidate.to_id, a, b)
    ]
    if tried:
        best = max(tried, key=lambda one: (one.inliers, one.matches))
        return {"from": best.from_id, "to": best.to_id, "inliers": best.inliers, **_refusal(best)}
    beliefs = [
        (update.value, update.id, update.best_id)
        for update in reader.updates()
        if update.best_id and not math.isnan(update.value) and _across(map_id_of, update.id, update.best_id, a, b)
    ]
    if not beliefs:
        return {"test": "hypothesis", "text": "no node of the one was the most likely place of a node of the other"}
    value, node_id, best_id = max(beliefs)
    params = reader.parameters()
    threshold = float(params.get("RGBD/AggressiveLoopThr", params.get("Rtabmap/LoopThr", "nan")))
    text = f"hypothesis {value:.3f} was the highest between them and not tried (RGBD/AggressiveLoopThr {threshold:g})"
    return {
        "from": node_id,
        "to": best_id,
        "test": "RGBD/AggressiveLoopThr",
        "value": value,
        "threshold": threshold,
        "text": text,
    }


def _refusal(candidate: Candidate) -> dict[str, Any]:
    why = candidate.refusal
    if why is None:
        return {"test": "decision", "text": "it was accepted, and taken out again by a decision"}
    number = {key: None if math.isnan(v) else v for key, v in (("value", why.value), ("threshold", why.threshold))}
    return {"test": why.test, **number, "text": why.text}


def _across(map_id_of: dict[int, int], first: int, second: int, a: Sequence[int], b: Sequence[int]) -> bool:
    i, j = map_id_of.get(first), map_id_of.get(second)
    return (i in a and j in b) or (i in b and j in a)
