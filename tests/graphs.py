"""Pose graphs for tests: a robot that drives circles, with odometry that drifts and loops that don't."""

from __future__ import annotations

import numpy as np

from slam.geometry import Array, Pose, between, se3_exp
from slam.graph import PoseGraph
from slam.types import Link, LinkType

SIGMA = np.array([0.01, 0.01, 0.01, 0.003, 0.003, 0.003])
INFORMATION = np.diag(SIGMA**-2)
LAP = 20


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
