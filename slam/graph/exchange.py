"""Put a link into a graph or take one out, and let the poses follow: as a whole or not at all."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from slam.graph.graph import Pair, PoseGraph
from slam.graph.optimizer import choose_root, optimize
from slam.graph.shift import Snapshot
from slam.graph.verify import join
from slam.params import Params
from slam.types import Link


@contextmanager
def with_link(graph: PoseGraph, link: Link, params: Params, there: Snapshot | None = None) -> Iterator[int]:
    """The graph with one more link and its poses optimised; if the block raises, it is as it was.

    Args:
        graph: changed in place.
        link: to put in; two graphs that meet in it are first brought together rigidly.
        params: for the optimisation.
        there: the poses of the graph afterwards where they are known; None optimises.

    Yields:
        0, the number of nodes that lose their way to the oldest.

    Raises:
        OptimizationError: the link does not fit the graph, or there is no solution.
    """
    poses, added, kept = graph.poses, False, False
    graph.poses = dict(poses)
    try:
        join(graph, link)
        added = True
        _settle(graph, link.pair, params, there)
        yield 0
        kept = True
    finally:
        if not kept:
            graph.poses = poses
            if added:
                graph.remove_link(link.pair)


@contextmanager
def without_link(graph: PoseGraph, pair: Pair, params: Params, there: Snapshot | None = None) -> Iterator[int]:
    """The graph without the link of a pair and its poses optimised; if the block raises, it is as it was.

    Args:
        graph: changed in place.
        pair: both ids.
        params: for the optimisation.
        there: the poses of the graph afterwards where they are known; None optimises.

    Yields:
        The number of nodes that lose their way to the oldest node: they keep their poses.

    Raises:
        OptimizationError: there is no such link, or no solution without it.
    """
    poses, kept = graph.poses, False
    link = graph.remove_link(pair)
    try:
        _settle(graph, pair, params, there)
        yield _separated(graph, pair)
        kept = True
    finally:
        if not kept:
            graph.poses = poses
            graph.add_link(link)


def _settle(graph: PoseGraph, pair: Pair, params: Params, there: Snapshot | None) -> None:
    if there is not None:
        graph.poses = there.poses()
        return
    roots = [choose_root(graph, params, node_id) for node_id in pair]
    graph.poses = optimize(graph, params, root=min(roots)).poses


def _separated(graph: PoseGraph, pair: Pair) -> int:
    sides = [graph.component(node_id) for node_id in pair]
    return 0 if pair[1] in sides[0] else len(max(sides, key=min))
