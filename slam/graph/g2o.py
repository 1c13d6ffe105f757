"""Pose graphs as g2o text: ``SE3:QUAT`` both ways, ``SE2`` read and lifted to three dimensions.

The format: https://github.com/RainerKuemmerle/g2o/wiki/File-Format. Information is the upper triangle by rows, in the
order x y z and rotation. Rotational information is taken as that of the rotation vector, as GTSAM and others do.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from slam.errors import DatabaseError
from slam.geometry import (
    Array,
    Pose,
    adjoint,
    between,
    from_quat_xyzw,
    inverse,
    make,
    se3_exp,
    se3_log,
    to_quat_xyzw,
)
from slam.graph.graph import PoseGraph, ascending
from slam.saving import save
from slam.types import Link, LinkType

#: Information of z, roll and pitch of a planar link: planar data has no residual there, so any moderate value will do.
_PLANAR_INFORMATION = 100.0
_UPPER_SE3 = np.triu_indices(6)
_PLANAR_AXES = np.array([0, 1, 5])
_FIELDS = {"VERTEX_SE3:QUAT": 8, "EDGE_SE3:QUAT": 30, "VERTEX_SE2": 4, "EDGE_SE2": 11}


def read_g2o(path: Path) -> PoseGraph:
    """The graph of a g2o file; its vertices are both odometry and optimised poses.

    Edges between consecutive ids become neighbour links, the others global closures, all from the smaller id (the
    information is carried over to the other end). Several edges of a pair are fused: a graph has one link for each.

    Raises:
        DatabaseError: the file can't be read, or a line isn't what its tag promises (named with its number).
    """
    graph = PoseGraph()
    edges: dict[tuple[int, int], Link] = {}
    for number, tag, numbers in _lines(path):
        if tag.startswith("VERTEX"):
            if int(numbers[0]) in graph:
                raise DatabaseError(f"{path}, line {number}: vertex {int(numbers[0])} is there already")
            T_map_base = _pose(tag, numbers[1:])
            graph.add_node(int(numbers[0]), 0, T_map_base, T_map_base)
        else:
            link = _edge(tag, numbers)
            edges[link.pair] = _fused(edges[link.pair], link) if link.pair in edges else link
    for link in edges.values():
        if link.from_id == link.to_id or not {link.from_id, link.to_id} <= graph.poses.keys():
            raise DatabaseError(f"{path}: edge {link.from_id} {link.to_id} needs two vertices of the file")
        graph.add_link(link)
    return graph


def read_edges(path: Path) -> list[Link]:
    """Every edge of a g2o file from its smaller id, several of one pair too; raises what ``read_g2o`` raises."""
    return [_edge(tag, numbers) for _, tag, numbers in _lines(path) if tag.startswith("EDGE")]


def write_g2o(path: Path, graph: PoseGraph) -> None:
    """Write poses and the links between them (from the smaller id) as SE3:QUAT, with all digits.

    Raises:
        DatabaseError: the file can't be written.
    """
    lines = [f"VERTEX_SE3:QUAT {i} {_pose_text(graph.poses[i])}" for i in sorted(graph.poses)]
    for pair in sorted(graph.links):
        link = ascending(graph.links[pair])
        if not graph.poses.keys() >= set(pair):
            continue
        assert link.T_from_to is not None
        information = " ".join(repr(float(v)) for v in link.information[_UPPER_SE3])
        lines.append(f"EDGE_SE3:QUAT {link.from_id} {link.to_id} {_pose_text(link.T_from_to)} {information}")
    save(path, "\n".join([*lines, ""]))


def _lines(path: Path) -> Iterator[tuple[int, str, Array]]:
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise DatabaseError(f"{path}: can't be read as a g2o text file ({error})") from error
    for number, line in enumerate(text.splitlines(), start=1):
        tag, *fields = line.split() or ["#"]
        if tag not in _FIELDS:
            if tag.startswith("#") or tag == "FIX":
                continue
            raise DatabaseError(f"{path}, line {number}: {tag} is not supported; known are {', '.join(_FIELDS)}")
        try:
            numbers = np.array([float(field) for field in fields])
        except ValueError as error:
            raise DatabaseError(f"{path}, line {number}: {tag} needs numbers ({error})") from error
        if len(numbers) != _FIELDS[tag] or not np.isfinite(numbers).all():
            raise DatabaseError(f"{path}, line {number}: {tag} needs {_FIELDS[tag]} finite numbers, has {len(numbers)}")
        yield number, tag, numbers


def _pose(tag: str, numbers: Array) -> Pose:
    if tag.endswith("SE3:QUAT"):
        return from_quat_xyzw(numbers[3:7], numbers[:3])
    x, y, yaw = numbers[:3]
    c, s = np.cos(yaw), np.sin(yaw)
    return make(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.array([x, y, 0.0]))


def _edge(tag: str, numbers: Array) -> Link:
    from_id, to_id = int(numbers[0]), int(numbers[1])
    if tag == "EDGE_SE3:QUAT":
        information = _symmetric(numbers[9:], 6)
    else:
        information = _PLANAR_INFORMATION * np.eye(6)
        information[np.ix_(_PLANAR_AXES, _PLANAR_AXES)] = _symmetric(numbers[5:], 3)
    kind = LinkType.NEIGHBOR if abs(from_id - to_id) == 1 else LinkType.GLOBAL_CLOSURE
    T_from_to = _pose(tag, numbers[2:])
    if from_id > to_id:
        # log(T^-1 X^-1) = -Ad(T^-1) log(T X): how the residual of T looks from the other end.
        from_id, to_id, T_from_to = to_id, from_id, inverse(T_from_to)
        Ad = adjoint(T_from_to)
        information = Ad.T @ information @ Ad
    return Link(from_id, to_id, kind, T_from_to, information)


def _fused(a: Link, b: Link) -> Link:
    """One link for two of the same pair: the mean weighted by information, with the sum of both informations."""
    assert a.T_from_to is not None and b.T_from_to is not None
    information: Array = a.information + b.information
    pull = b.information @ se3_log(between(a.T_from_to, b.T_from_to))
    step = np.asarray(np.linalg.solve(information, pull), dtype=np.float64)
    return Link(a.from_id, a.to_id, a.type, a.T_from_to @ se3_exp(step), information)


def _symmetric(upper: Array, size: int) -> Array:
    matrix = np.zeros((size, size))
    matrix[np.triu_indices(size)] = upper
    return matrix + np.triu(matrix, 1).T


def _pose_text(T: Pose) -> str:
    return " ".join(repr(float(v)) for v in (*T[:3, 3], *to_quat_xyzw(T)))
