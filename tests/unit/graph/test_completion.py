"""Poses that a file lacks come from its links, in the frame of those that it has."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from slam.database import MapReader
from slam.evaluate import align
from slam.geometry import between, make, rotation_angle, so3_exp, translation_norm
from slam.graph import PoseGraph
from slam.graph.completion import completed
from slam.params import Params
from slam.types import Link, LinkType

INFORMATION = np.diag([100.0] * 3 + [400.0] * 3)


def circle(count: int) -> dict[int, np.ndarray]:
    """Poses around a circle, looking along it."""
    turn = 2 * np.pi / count
    step = make(so3_exp(np.array([0.0, 0.0, turn])), np.array([1.0, 0.0, 0.0]))
    poses = {1: make(np.eye(3), np.array([3.0, 2.0, 1.0]))}
    for node_id in range(2, count + 1):
        poses[node_id] = poses[node_id - 1] @ step
    return poses


def graph_of(truth: dict[int, np.ndarray], drift: float) -> PoseGraph:
    """Odometry that turns too far, and one loop that tells."""
    graph = PoseGraph()
    off = make(so3_exp(np.array([0.0, 0.0, drift])), np.zeros(3))
    ids = sorted(truth)
    T = truth[ids[0]]
    for before, node_id in zip([None, *ids], ids, strict=False):
        if before is not None:
            T = T @ between(truth[before], truth[node_id]) @ off
        graph.add_node(node_id, 0, T, T)
    for a, b in pairwise(ids):
        graph.add_link(Link(b, a, LinkType.NEIGHBOR, between(graph.T_odom[b], graph.T_odom[a]), INFORMATION))
    a, b = ids[-1], ids[0]
    graph.add_link(Link(a, b, LinkType.GLOBAL_CLOSURE, between(truth[a], truth[b]), 1e4 * INFORMATION))
    return graph


def test_without_any_pose_the_oldest_node_is_where_odometry_has_it() -> None:
    truth = circle(12)
    graph = graph_of(truth, 0.02)
    poses = completed(graph, {}, Params())
    assert poses.keys() == truth.keys()
    np.testing.assert_allclose(poses[1], truth[1], atol=1e-9)
    assert (
        translation_norm(between(poses[12], truth[12])) < 0.05 < translation_norm(between(graph.T_odom[12], truth[12]))
    )


def test_what_is_stored_says_where_the_rest_is() -> None:
    truth = circle(8)
    away = make(so3_exp(np.array([0.0, 0.0, 1.0])), np.array([10.0, 0.0, 0.0]))
    stored = {i: away @ truth[i] for i in (5, 6, 7)}
    found = completed(graph_of(truth, 0.0), stored, Params())
    assert sorted(found) == [1, 2, 3, 4, 8]
    for node_id, T in found.items():
        np.testing.assert_allclose(T, away @ truth[node_id], atol=1e-6)


def test_nothing_is_done_where_nothing_is_missing_or_linked() -> None:
    truth = circle(4)
    assert completed(graph_of(truth, 0.0), truth, Params()) == {}
    graph = PoseGraph()
    graph.add_node(1, 0, truth[1], truth[1])
    assert completed(graph, {}, Params()) == {}


def test_landmarks_get_a_place() -> None:
    truth = circle(4)
    graph = graph_of(truth, 0.0)
    T_base_tag = make(np.eye(3), np.array([1.0, 0.0, 0.5]))
    for node_id in (1, 2):
        T = between(truth[node_id], truth[1] @ T_base_tag)
        graph.add_constraint(Link(node_id, -7, LinkType.LANDMARK, T, INFORMATION))
    np.testing.assert_allclose(completed(graph, {}, Params())[-7], truth[1] @ T_base_tag, atol=1e-6)


@pytest.mark.parametrize("name", ["toyroom", "tum_fr1_xyz_excerpt"])
@pytest.mark.parametrize("kept", [0, 5])
def test_poses_of_rtabmap_come_out_of_its_links(shared_data: Path, name: str, kept: int) -> None:
    reader = MapReader(shared_data / "rtabmap_db" / f"cpp_0.23.8_{name}.db")
    theirs = reader.poses()
    stored = {i: theirs[i] for i in sorted(theirs)[len(theirs) - kept :]}
    ours = stored | completed(PoseGraph.from_reader(reader), stored, Params())
    assert ours.keys() == theirs.keys()
    ids = sorted(theirs)
    T_theirs, T_ours = np.array([theirs[i] for i in ids]), np.array([ours[i] for i in ids])
    T = align(T_theirs[:, :3, 3], T_ours[:, :3, 3])
    apart = [between(a, T @ b) for a, b in zip(T_theirs, T_ours, strict=True)]
    assert np.sqrt(np.mean([translation_norm(d) ** 2 for d in apart])) < 0.001
    assert np.degrees(np.sqrt(np.mean([rotation_angle(d) ** 2 for d in apart]))) < 0.05


def test_a_file_of_a_killed_program_gets_poses(shared_data: Path) -> None:
    (path,) = (shared_data / "rtabmap_db").glob("Strroke21*.db")
    reader = MapReader(path)
    poses = completed(PoseGraph.from_reader(reader), reader.poses(), Params())
    table = reader.nodes()
    assert sorted(poses) == table.ids[table.weights > -9].tolist()
