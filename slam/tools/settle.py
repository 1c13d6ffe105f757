"""Optimising a whole map file, and its grid with it."""

from __future__ import annotations

from slam.database import MapReader, MapWriter
from slam.errors import OptimizationError
from slam.graph.graph import PoseGraph
from slam.graph.optimizer import optimize
from slam.graph.problem import choose_root
from slam.maps.grid_rebuild import GridRebuild
from slam.params import Params


def settle(writer: MapWriter, graph: PoseGraph, params: Params) -> list[str]:
    """Optimise every piece of a graph and store poses and grid.

    Returns:
        Why a piece could not be optimised; it keeps its poses.
    """
    refused, left = [], set(graph.poses)
    while left:
        root = choose_root(graph, params, min(left))
        left -= graph.component(root) | {min(left)}
        try:
            graph.poses = optimize(graph, params, root=root).poses
        except OptimizationError as error:
            refused.append(f"the nodes joined with {root} keep their poses: {error}")
    writer.save_poses(graph.poses, None)
    GridRebuild(MapReader(writer.path), writer, graph, params).carry_out()
    return refused
