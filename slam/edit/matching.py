"""Two nodes that a person names, registered the way that person asks for."""

from __future__ import annotations

import numpy as np

from slam.edit.views import StoredViews
from slam.edit.wishes import Matching, Method
from slam.errors import DecisionError
from slam.geometry import Array, Pose, between
from slam.graph.graph import PoseGraph
from slam.params import Params
from slam.registration.choice import VisualThenIcp
from slam.registration.icp import IcpRegistration
from slam.registration.view import Registrar
from slam.registration.visual import VisualRegistration
from slam.types import Registration


def registrar_of(method: Method) -> Registrar:
    """The registration of a method."""
    if method == "visual":
        return VisualRegistration()
    return IcpRegistration() if method == "icp" else VisualThenIcp(always=True)


def matched(
    views: StoredViews, graph: PoseGraph, from_id: int, to_id: int, how: Matching, params: Params
) -> Registration:
    """``T_from_to`` with its evidence, or the test that refused it.

    Raises:
        DecisionError: a node is not in the graph or can't be compared, or the graph has no guess.
    """
    for node_id in (from_id, to_id):
        if node_id not in graph:
            raise DecisionError(f"node {node_id} is not in the map")
    guess = _guess(graph, from_id, to_id) if how.guess == "graph" else None
    return around(views, from_id, to_id, guess, how.method, params)


def around(
    views: StoredViews, from_id: int, to_id: int, guess: Pose | None, method: Method, params: Params
) -> Registration:
    """The same around a first ``T_from_to``."""
    view_from, view_to = (views.of(node_id, params, cloud=method != "visual") for node_id in (from_id, to_id))
    return registrar_of(method).register(view_from, view_to, guess, params)


def information_of(found: Registration) -> Array:
    """(6, 6) of a registration that was not refused."""
    information = np.linalg.inv(found.covariance)
    return np.asarray(0.5 * (information + information.T), np.float64)


def _guess(graph: PoseGraph, from_id: int, to_id: int) -> Pose:
    if to_id not in graph.component(from_id):
        raise DecisionError(
            f"nodes {from_id} and {to_id} are in graphs that no link joins, whose poses tell nothing about each other:"
            " match them without a guess"
        )
    return between(graph.poses[from_id], graph.poses[to_id])
