"""Pose graphs for tests: a robot that drives circles, with odometry that drifts and loops that don't."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from slam.camera import Camera
from slam.database import MapWriter, NodeRecord
from slam.features.words import nothing_seen
from slam.geometry import Array, Pose, between, se3_exp
from slam.graph import PoseGraph
from slam.params import Params
from slam.types import Candidate, Link, LinkType, Node, Odometry, Update

SIGMA = np.array([0.01, 0.01, 0.01, 0.003, 0.003, 0.003])
INFORMATION = np.diag(SIGMA**-2)
LAP = 20
CAMERA = Camera(64, 48, 52.5, 52.5, 31.5, 23.5)


def truth(nodes: int) -> list[Pose]:
    """True poses on a rising circle of ``LAP`` nodes a lap."""
    step = se3_exp(np.array([0.3, 0.0, 0.01, 0.0, 0.0, 2 * np.pi / LAP]))
    poses = [np.eye(4)]
    for _ in range(nodes - 1):
        poses.append(np.asarray(poses[-1] @ step))
    return poses


def noisy(T: Pose, rng: np.random.Generator, noise: float) -> Pose:
    """A measurement of T with ``noise`` times ``SIGMA``."""
    return np.asarray(T @ se3_exp(rng.normal(size=6) * SIGMA * noise))


def circles(nodes: int = 60, loops: int = 6, *, noise: float = 1.0, seed: int = 0) -> PoseGraph:
    """Ids 1..nodes on circles, joined by neighbour links and, one lap apart, by ``loops`` global closures."""
    rng = np.random.default_rng(seed)
    true, graph, T_odom = truth(nodes), PoseGraph(), np.eye(4)
    graph.add_node(1, 0, T_odom, T_odom)
    for i in range(1, nodes):
        step = noisy(between(true[i - 1], true[i]), rng, noise)
        T_odom = np.asarray(T_odom @ step)
        graph.add_node(i + 1, 0, T_odom, T_odom)
        graph.add_link(Link(i, i + 1, LinkType.NEIGHBOR, step, INFORMATION))
    for new in np.linspace(nodes, LAP + 1, loops).astype(int):
        graph.add_link(loop(int(new), int(new) - LAP, true, rng, noise))
    return graph


def loop(new: int, old: int, true: list[Pose], rng: np.random.Generator, noise: float = 1.0) -> Link:
    """A measured global closure from id ``new`` to id ``old``."""
    T = noisy(between(true[new - 1], true[old - 1]), rng, noise)
    return Link(new, old, LinkType.GLOBAL_CLOSURE, T, INFORMATION)


def stacked(poses: dict[int, Pose]) -> Array:
    """Poses (N, 4, 4) by ascending id."""
    return np.array([poses[i] for i in sorted(poses)])


def write_map(path: Path, graph: PoseGraph, candidates: Mapping[int, tuple[Candidate, ...]] | None = None) -> Path:
    """A closed map file of this graph, with loop candidates by the node of their update."""
    features = nothing_seen()
    with MapWriter.create(path, Params(), seed=0, source="made up") as writer:
        for i in sorted(graph.poses):
            node = Node(i, 0, 0, float(i), graph.T_odom[i], features, np.zeros(0, np.int32), CAMERA)
            odometry = Odometry(node.T_odom_base, np.eye(6), features, 0, 0, True, None, 1.0)
            update = Update(i, node.stamp, odometry, graph.poses[i], node, candidates=(candidates or {}).get(i, ()))
            links = tuple(graph.links[pair] for pair in sorted(graph.links) if pair[1] == i)
            writer.add_node(NodeRecord(node=node, update=update, links=links))
        writer.save_poses(graph.poses, None)
        writer.close_session(ram_ids=sorted(graph.poses), ram_word_ids=[], params=Params())
    return path
