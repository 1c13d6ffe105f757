"""What people do to all poses at once: keep those of an optimisation of their own, or turn the map as it is."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from slam.database import JournalEntry, MapReader
from slam.earth import TangentPlane
from slam.edit.wishes import Optimisation, Turn
from slam.errors import DecisionError
from slam.evaluate import align
from slam.geometry import Array, Pose, from_euler_rpy, make
from slam.graph.graph import PoseGraph
from slam.graph.problem import Problem, choose_root
from slam.params import Params
from slam.types import Manner, Placement

#: Positions that lay a map over others, and how far apart they must be, metres.
_LEAST, _LEAST_M = 3, 1.0
_SOLVERS = ("Levenberg-Marquardt", "Gauss-Newton", "Dogleg")
_FRAMES = {"truth": "the ground truth", "gps": "GPS (x east, y north)"}


def optimising(graph: PoseGraph, params: Params, wanted: Optimisation) -> JournalEntry:
    """The entry that keeps the poses of an optimisation.

    Raises:
        DecisionError: the map has no such root.
    """
    manner = wanted.manner
    if manner.root is not None and manner.root not in graph:
        raise DecisionError(f"the map has no node {manner.root} to hold fixed")
    root = choose_root(graph, params, graph.newest) if manner.root is None else manner.root
    placement = Placement(manner=manner, step=wanted.step)
    return _entry("optimise", root, placement, _told(manner, root, wanted.step), wanted.author)


def turning(graph: PoseGraph, params: Params, reader: MapReader, wanted: Turn) -> JournalEntry:
    """The entry that turns the map about the origin, or lays it over the true path or over GPS.

    Laid over GPS, and where gravity counts or the robot stays on a plane, the map stays level: yaw alone is turned.

    Raises:
        DecisionError: priors count, which hold the map where it is, or there is nothing to lay it over.
    """
    root = choose_root(graph, params, graph.newest)
    problem = Problem.of(graph, root, params)
    if problem.priors:
        raise DecisionError(
            f"{len(problem.priors)} priors count in this map: they say where it is, and the next decision would turn it"
            " back. Switch Optimizer/PriorsIgnored on first"
        )
    if wanted.to is None:
        T = from_euler_rpy(np.array([0.0, 0.0, wanted.yaw_rad]), np.zeros(3))
        return _entry("turn", root, Placement(T_new_old=T), f"by {np.degrees(wanted.yaw_rad):g}°", wanted.author)
    known = _truth(reader) if wanted.to == "truth" else _enu(reader)
    ids = [i for i in sorted(known) if i in graph]
    there, here = np.array([known[i] for i in ids]), np.array([graph.poses[i][:3, 3] for i in ids])
    what = _FRAMES[wanted.to]
    if len(ids) < _LEAST or float(np.ptp(there[:, :2], axis=0).max()) < _LEAST_M:
        raise DecisionError(
            f"{len(ids)} nodes of the map know where they are by {what}; {_LEAST} are needed, over {_LEAST_M:g} m at"
            " least, to lay the map over them"
        )
    flat = params.Reg.Force3DoF
    T = _levelled(there, here, flat=flat) if flat or problem.gravity or wanted.to == "gps" else align(there, here)
    return _entry("turn", root, Placement(T_new_old=T), f"laid over {what} at {len(ids)} nodes", wanted.author)


def _truth(reader: MapReader) -> Mapping[int, Array]:
    table = reader.nodes()
    rows = zip(table.ids.tolist(), table.T_world[:, :3, 3], strict=True)
    return {node_id: position for node_id, position in rows if np.isfinite(position).all()}


def _enu(reader: MapReader) -> Mapping[int, Array]:
    """East, north and up from the first reading, metres."""
    readings = sorted(reader.gps().items())
    if not readings:
        return {}
    geodetic = np.array([(gps.longitude, gps.latitude, gps.altitude) for _, gps in readings], np.float64)
    return dict(zip((i for i, _ in readings), TangentPlane(*geodetic[0]).to_enu(geodetic), strict=True))


def _levelled(points_a: Array, points_b: Array, *, flat: bool) -> Pose:
    """T_a_b of yaw and translation alone; flat without one along z. Closest in the plane, as ``align`` in space."""
    a, b = points_a - points_a.mean(axis=0), points_b - points_b.mean(axis=0)
    yaw = np.arctan2((b[:, 0] * a[:, 1] - b[:, 1] * a[:, 0]).sum(), (a[:, :2] * b[:, :2]).sum())
    R = from_euler_rpy(np.array([0.0, 0.0, yaw]), np.zeros(3))[:3, :3]
    t = points_a.mean(axis=0) - R @ points_b.mean(axis=0)
    return make(R, t * [1.0, 1.0, 0.0 if flat else 1.0])


def _entry(action: str, node_id: int, placement: Placement, note: str, author: str) -> JournalEntry:
    return JournalEntry(action=action, from_id=node_id, to_id=node_id, author=author, note=note, placement=placement)


def _told(manner: Manner, root: int, step: int | None) -> str:
    said = [f"root {root}"]
    said += [f"without {', '.join(kind.label for kind in manner.without)}"] if manner.without else []
    said += [] if manner.solver is None else [_SOLVERS[manner.solver]]
    said += [] if manner.kernel is None else ["no kernel" if manner.kernel == "none" else f"kernel {manner.kernel}"]
    said += [f"from {manner.start}"] if manner.start == "odometry" else ["from the map's poses"]
    said += [] if step is None else [f"iteration {step}"]
    return "; ".join(said)
