"""What the graph says against links that a person puts into it (``RGBD/OptimizeMaxError``)."""

from __future__ import annotations

from collections.abc import Sequence

from slam.errors import OptimizationError
from slam.graph.graph import Pair, PoseGraph
from slam.graph.verify import Closure, close_loops
from slam.params import Params
from slam.types import Link, Refusal


def tried(graph: PoseGraph, add: Sequence[Link], params: Params, remove: Sequence[Pair] = ()) -> Closure:
    """The outcome of closing these links in place of others; the graph stays as it is.

    Raises:
        OptimizationError: a link does not fit the graph, or there is no solution.
    """
    poses, removed = graph.poses, list[Link]()
    closure: Closure | None = None
    try:
        for pair in remove:
            removed.append(graph.remove_link(pair))
        closure = close_loops(graph, add, params)
        return closure
    finally:
        if closure is not None and closure.accepted:
            for link in reversed(add):
                graph.remove_link(link.pair)
        graph.poses = poses
        for link in reversed(removed):
            graph.add_link(link)


def objection(graph: PoseGraph, add: Sequence[Link], params: Params, remove: Sequence[Pair] = ()) -> Refusal | None:
    """Why the graph can't live with these links, None when it can."""
    try:
        return tried(graph, add, params, remove).refusal
    except OptimizationError as error:
        return Refusal("optimization", float("nan"), float("nan"), str(error))
