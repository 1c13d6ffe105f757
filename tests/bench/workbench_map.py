"""Maps of any size for the workbench: circles with true loops, what their updates believed, and clouds of points."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from slam.camera import Camera
from slam.database import MapWriter, NodeRecord
from slam.features.words import nothing_seen
from slam.graph import PoseGraph, optimize
from slam.params import Params
from slam.types import Candidate, Link, Node, Odometry, Update
from tests.graphs import circles

#: Each cloud has 10,000 points: depth images of 100x100 of a wall, so near that none of them are taken for a ceiling.
_SIDE, _WALL_M = 100, 1.0
_CAMERA = Camera(_SIDE, _SIDE, 60.0, 60.0, 49.5, 49.5)


def write_workbench_map(path: Path, nodes: int, loops: int, clouds: int = 0) -> PoseGraph:
    """A closed map file, optimised; ``clouds`` of its nodes have images, evenly spread."""
    graph, params, rng = circles(nodes, loops), Params(), np.random.default_rng(0)
    graph.poses = optimize(graph, params).poses
    seen = set(np.linspace(1, nodes, clouds).astype(int).tolist())
    with MapWriter.create(path, params, seed=0, source="made up") as writer:
        for i in sorted(graph.poses):
            writer.add_node(_record(graph, i, rng, with_images=i in seen))
        writer.save_poses(graph.poses, None)
        writer.close_session(ram_ids=sorted(graph.poses), ram_word_ids=[], params=params)
    return graph


def _record(graph: PoseGraph, i: int, rng: np.random.Generator, *, with_images: bool) -> NodeRecord:
    links = _ending(graph, i)
    candidates = tuple(_candidate(link, rng) for link in links if link.type.is_loop)
    node = Node(i, 0, 0, float(i), graph.T_odom[i], nothing_seen(), np.zeros(0, np.int32), _CAMERA)
    odometry = Odometry(node.T_odom_base, np.eye(6), nothing_seen(), 0, 0, True, None, 1.0)
    update = Update(i, node.stamp, odometry, graph.poses[i], node, candidates=candidates)
    best = candidates[0] if candidates else None
    statistics = {
        "Loop/Highest_hypothesis_id/": 0.0 if best is None else float(best.to_id),
        "Loop/Highest_hypothesis_value/": 0.02 if best is None else best.posterior,
        "Timing/Total/ms": float(rng.uniform(20.0, 60.0)),
    }
    image = rng.integers(0, 255, (_SIDE, _SIDE, 3)).astype(np.uint8) if with_images else None
    depth = np.full((_SIDE, _SIDE), _WALL_M, np.float32) if with_images else None
    return NodeRecord(node=node, update=update, links=links, statistics=statistics, image_bgr=image, depth_m=depth)


def _ending(graph: PoseGraph, i: int) -> tuple[Link, ...]:
    """Links to older nodes."""
    return tuple(link for other, link in sorted(graph.neighbors(i).items()) if other < i)


def _candidate(link: Link, rng: np.random.Generator) -> Candidate:
    """The evidence of a loop that was accepted."""
    new, old = max(link.pair), min(link.pair)
    value = float(rng.uniform(0.12, 0.95))
    return Candidate(new, old, link.type, value, 120, 80, link.T_from_to, link.information, None)
