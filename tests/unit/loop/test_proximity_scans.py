"""Proximity by scans: the clouds of an old path, merged, against the new node's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slam.geometry import between, inverse, rotation_angle, se3_exp, translation_norm
from slam.graph.graph import PoseGraph
from slam.loop.proximity_scans import by_scans, poses_along
from slam.memory.long_term import RamMemory
from slam.memory.memory import Memory
from slam.params import Params, Value
from slam.types import Candidate, LinkType, Refusal, Scan
from tests.clouds import CORNER, scan
from tests.nodes import add_place, at, join, random_descriptors

PARAMS = Params().changed({"Mem/STMSize": 2, "Reg/Strategy": 1, "RGBD/ProximityPathMaxNeighbors": 1})
DRIFT = se3_exp(np.array([0.05, -0.04, 0.03, 0.01, -0.01, 0.02]))


def changed(**values: Value) -> Params:
    return PARAMS.changed({name.replace("_", "/"): value for name, value in values.items()})


def mapped(*, scans: bool = True, drift: float = 1.0) -> tuple[Memory, PoseGraph]:
    """Five old nodes along x, a gap, and a new one beside the third, whose pose in the map is off by ``DRIFT``."""
    memory, graph = Memory(RamMemory(), seed=0), PoseGraph()
    for k in range(7):
        T = at(0.2 * k) if k < 5 else at(0.42 + 4.0 * (k == 5), 0.05, 5.0)
        place = add_place(memory, graph, random_descriptors(20, k), PARAMS, pose=T)
        cloud = scan(CORNER, T, k) if scans else None
        memory.nodes[place.id] = replace(place, scan=cloud)
    graph.poses[7] = np.asarray(graph.poses[7] @ (DRIFT if drift else np.eye(4)))
    return memory, graph


def looked(memory: Memory, graph: PoseGraph, params: Params = PARAMS, *found: Candidate) -> list[Candidate]:
    return by_scans(memory.nodes[7], memory, graph, {}, found, params)


def test_the_nearest_node_is_joined_with_its_true_pose() -> None:
    memory, graph = mapped()
    (candidate,) = looked(memory, graph)
    assert (candidate.from_id, candidate.to_id, candidate.type) == (7, 3, LinkType.LOCAL_SPACE_CLOSURE)
    assert candidate.refusal is None
    assert candidate.by_scans
    assert candidate.T_from_to is not None
    error = between(between(at(0.42, 0.05, 5.0), at(0.4)), candidate.T_from_to)
    assert translation_norm(error) < 0.005
    assert rotation_angle(error) < 0.003
    assert 0.5 * candidate.matches < candidate.inliers <= candidate.matches


def test_the_covariance_factor_divides_the_information() -> None:
    memory, graph = mapped()
    (loose,), (tight,) = looked(memory, graph), looked(memory, graph, changed(RGBD_ProximityMergedScanCovFactor=1.0))
    assert loose.information is not None
    assert tight.information is not None
    np.testing.assert_allclose(tight.information, 100 * loose.information)


def test_neighbours_fill_in_what_the_nearest_did_not_see() -> None:
    memory, graph = mapped()
    for k, side in ((2, 1.0), (3, 0.0), (4, -1.0)):
        whole = memory.nodes[k].scan
        assert whole is not None
        far = whole.points_base[:, 0] > 2.0
        seen = far if side == 0 else ~far & (np.arange(len(whole)) % 2 == (side > 0))
        memory.nodes[k] = replace(memory.nodes[k], scan=Scan(whole.points_base[seen]))
    (merged,) = looked(memory, graph)
    (alone,) = looked(memory, graph, changed(RGBD_ProximityPathMaxNeighbors=0))
    assert merged.inliers > 1.3 * alone.inliers


@pytest.mark.parametrize("raw", [True, False])
def test_clouds_are_merged_by_links_or_by_optimised_poses(raw: bool) -> None:
    memory, graph = mapped()
    for k in (2, 4):
        graph.poses[k] = np.asarray(graph.poses[k] @ at(-0.04, 0.04))
    (candidate,) = looked(memory, graph, changed(RGBD_ProximityPathRawPosesUsed=raw))
    assert candidate.T_from_to is not None
    error = between(between(at(0.42, 0.05, 5.0), at(0.4)), candidate.T_from_to)
    assert translation_norm(error) < 0.003 if raw else translation_norm(error) > 0.006


def test_the_correspondence_ratio_is_doubled() -> None:
    memory, graph = mapped()
    (candidate,) = looked(memory, graph, changed(Icp_CorrespondenceRatio=0.5))
    assert candidate.refusal is not None
    assert candidate.refusal.test == "Icp/CorrespondenceRatio"
    assert candidate.refusal.threshold == 1.0
    assert candidate.T_from_to is None
    assert candidate.information is None


def test_a_place_that_is_too_far_or_joined_is_left_alone() -> None:
    memory, graph = mapped()
    assert looked(memory, graph, changed(RGBD_ProximityPathFilteringRadius=0.05)) == []
    by_images = Candidate(7, 4, LinkType.LOCAL_SPACE_CLOSURE, 0.5, 90, 60, np.eye(4), np.eye(6), None)
    assert looked(memory, graph, PARAMS, by_images) == []
    refused = replace(by_images, refusal=Refusal("Vis/MinInliers", 1.0, 20.0, "1 inlier"))
    assert len(looked(memory, graph, PARAMS, refused)) == 1
    join(graph, 7, 2)
    assert looked(memory, graph) == []


def test_without_clouds_nothing_is_compared() -> None:
    memory, graph = mapped(scans=False)
    assert looked(memory, graph) == []


def test_a_new_node_without_a_cloud_says_so() -> None:
    memory, graph = mapped()
    memory.nodes[7] = replace(memory.nodes[7], scan=None)
    (candidate,) = looked(memory, graph)
    assert candidate.refusal is not None
    assert candidate.refusal.test == "scan"
    assert candidate.matches == candidate.inliers == -1


def test_the_link_has_the_direction_of_all_loops() -> None:
    memory, graph = mapped(drift=0.0)
    (candidate,) = looked(memory, graph)
    assert candidate.T_from_to is not None
    expected = inverse(graph.poses[7]) @ graph.poses[3]
    np.testing.assert_allclose(candidate.T_from_to, expected, atol=0.01)


@pytest.mark.parametrize(("most", "ids"), [(0, [3]), (1, [2, 3, 4]), (2, [1, 2, 3, 4]), (9, [1, 2, 3, 4])])
@pytest.mark.parametrize("raw", [True, False])
def test_so_many_neighbours_on_each_side_are_where_they_were(most: int, ids: list[int], raw: bool) -> None:
    _, graph = mapped()
    params = changed(RGBD_ProximityPathMaxNeighbors=most, RGBD_ProximityPathRawPosesUsed=raw)
    poses = poses_along(3, [1, 2, 3, 4], graph, params)
    assert sorted(poses) == ids
    for k, T_nearest_k in poses.items():
        np.testing.assert_allclose(T_nearest_k, between(graph.poses[3], graph.poses[k]), atol=1e-12)
