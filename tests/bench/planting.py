"""False loops planted in maps: whether they head the review queue, and whether taking them out mends the map.

What is planted is as sure as a loop of the map itself. It says that two nodes 15 apart, or any farther apart, are one
place; that they lie as another loop has it; or anything within two metres. Truth is the map as it was before.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from server.browse.map_view import MapView
from server.catalog import MapFile
from slam.geometry import Pose, between, se3_exp, translation_norm
from slam.graph import PoseGraph, optimize
from slam.graph.g2o import read_g2o
from slam.graph.suspicion import suspicions
from slam.params import Params
from slam.types import Link, LinkType
from tests.graphs import circles

#: Planted together, and the length of the queue in which they have to be.
PLANTED, QUEUE = 2, 5
KINDS = ("15 apart", "any apart", "of another loop", "anything")
_APART, _NEAR_M = 15, 2.0
#: What says nearly what is true is no false loop.
_TRUE_M, _TRUE_RAD = 0.3, 0.15


@dataclass(frozen=True, slots=True)
class Planting:
    """What came of one.

    Attributes:
        ranks: of the planted loops in the queue, 0 the first.
        seconds: that judging all loops took.
        bent_m: root mean square of how far the nodes were moved by the planting.
        mended_m: the same after the planted loops were rejected one after the other.
    """

    ranks: tuple[int, ...]
    seconds: float
    bent_m: float
    mended_m: float

    @property
    def found(self) -> bool:
        """Whether all of them are among the first of the queue."""
        return max(self.ranks) < QUEUE


Load = Callable[[], tuple[PoseGraph, Params]]


def maps(data: Path) -> dict[str, Load]:
    """Every map that this machine has, by its name: how to read its graph and parameters."""
    posegraphs, toyroom = data / "posegraphs", data / "rtabmap_db" / "cpp_0.23.8_toyroom.db"
    found: dict[str, Load] = {"map of 2,000 nodes": lambda: (circles(2000, 300), Params())}
    for name in ("intel", "sphere2500"):
        if (posegraphs / f"{name}.g2o").is_file():
            found[name] = partial(_text, posegraphs / f"{name}.g2o")
    if toyroom.is_file():
        found["toyroom of C++ RTAB-Map"] = partial(_database, toyroom)
    return found


def _text(path: Path) -> tuple[PoseGraph, Params]:
    return read_g2o(path), Params()


def _database(path: Path) -> tuple[PoseGraph, Params]:
    snapshot = MapView(MapFile(path.stem, path.stem, path)).snapshot()
    return snapshot.graph, snapshot.params


def plantings(graph: PoseGraph, params: Params, count: int) -> Iterator[Planting]:
    """So many plantings, each of the next kind; the graph stays as it is."""
    true = optimize(graph, params).poses
    for seed in range(count):
        rng = np.random.default_rng(seed)
        yield _planting(graph, params, true, _false_loops(graph, true, KINDS[seed % len(KINDS)], rng))


def summary(found: list[Planting]) -> dict[str, Any]:
    """Figures of many plantings."""
    return {
        "plantings": len(found),
        "found_percent": round(100.0 * float(np.mean([one.found for one in found])), 1),
        "seconds": round(float(np.median([one.seconds for one in found])), 3),
        "seconds_most": round(max(one.seconds for one in found), 3),
        "bent_m": round(float(np.median([one.bent_m for one in found])), 4),
        "mended_m": round(max(one.mended_m for one in found), 4),
    }


def _planting(graph: PoseGraph, params: Params, true: dict[int, Pose], false: list[Link]) -> Planting:
    planted = graph.copy()
    planted.poses = dict(true)
    for link in false:
        planted.add_link(link)
    planted.poses = optimize(planted, params).poses
    bent_m = _off_m(planted.poses, true)
    start = time.perf_counter()
    found = suspicions(planted, [link for link in planted.links.values() if link.type.is_loop], params)
    seconds = time.perf_counter() - start
    queue = sorted(found, key=lambda pair: -found[pair].score)
    for link in false:
        planted.remove_link(link.pair)
        planted.poses = optimize(planted, params).poses
    return Planting(tuple(queue.index(link.pair) for link in false), seconds, bent_m, _off_m(planted.poses, true))


def _off_m(poses: dict[int, Pose], true: dict[int, Pose]) -> float:
    return float(np.sqrt(np.mean([np.sum((poses[i][:3, 3] - T[:3, 3]) ** 2) for i, T in true.items()])))


def _false_loops(graph: PoseGraph, true: dict[int, Pose], kind: str, rng: np.random.Generator) -> list[Link]:
    loops = [graph.links[pair] for pair in sorted(graph.links) if graph.links[pair].type.is_loop]
    ids, found = sorted(graph.T_odom), dict[tuple[int, int], Link]()
    while len(found) < PLANTED:
        first = int(rng.integers(len(ids) - _APART))
        last = first + _APART if kind == KINDS[0] else int(rng.integers(first + _APART, len(ids)))
        like, T = loops[int(rng.integers(len(loops)))], _transform(kind, loops, rng)
        link = Link(ids[first], ids[last], LinkType.GLOBAL_CLOSURE, T, like.information)
        if link.pair not in graph.links and _is_false(link, true):
            found[link.pair] = link
    return list(found.values())


def _transform(kind: str, loops: list[Link], rng: np.random.Generator) -> Pose:
    if kind in KINDS[:2]:
        return np.eye(4)
    T = loops[int(rng.integers(len(loops)))].T_from_to
    if kind == KINDS[2] and T is not None:
        return T
    where = (*rng.uniform(-_NEAR_M, _NEAR_M, 2), 0.0, 0.0, 0.0, rng.uniform(-np.pi, np.pi))
    return np.asarray(se3_exp(np.array(where)))


def _is_false(link: Link, true: dict[int, Pose]) -> bool:
    assert link.T_from_to is not None
    error = between(link.T_from_to, between(true[link.from_id], true[link.to_id]))
    return translation_norm(error) > _TRUE_M or np.trace(error[:3, :3]) < 1.0 + 2.0 * np.cos(_TRUE_RAD)
