"""Placed graphs without a file."""

from __future__ import annotations

import numpy as np

from server.scene.placed import PlacedGraph
from slam.geometry import se3_exp


def long_walk(count: int) -> PlacedGraph:
    """Ids 1 to ``count`` on a walk that wanders about, without links."""
    T, poses = np.eye(4), []
    rng = np.random.default_rng(0)
    for _ in range(count):
        poses.append(T)
        T = np.asarray(T @ se3_exp(np.array([0.3, 0.0, 0.0, 0.0, 0.0, rng.normal() * 0.3])))
    ids, zero, placed = np.arange(1, count + 1), np.zeros(count, dtype=np.int64), np.array(poses).reshape(-1, 4, 4)
    return PlacedGraph(ids, placed, placed, placed, zero, zero, zero, {}, {int(i): int(i) - 1 for i in ids})


def first(graph: PlacedGraph, count: int) -> PlacedGraph:
    """The graph's oldest nodes, and the links between them."""
    links = {kind: rows[(rows < count).all(axis=1)] for kind, rows in graph.links.items()}
    columns = (graph.ids, graph.T_map, graph.T_odom, graph.T_world, graph.map_ids, graph.weights, graph.tiers)
    return PlacedGraph(
        *(column[:count] for column in columns), links, {i: row for i, row in graph.rows.items() if row < count}
    )
