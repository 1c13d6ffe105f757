"""Whole runs with clouds: nodes have them in every memory, links are refined, loops closed, all is repeatable."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slam.database import MapReader, MapWriter
from slam.geometry import between, inverse, translation_norm
from slam.params import Params
from slam.run import ate_rmse_m
from slam.slam import Slam
from slam.types import LinkType, Update
from tests.tours import EVERY, fed, sparse, there_and_back

CLOUDS = EVERY.changed(
    {
        "Reg/Strategy": 1,
        "RGBD/NeighborLinkRefining": True,
        "RGBD/ProximityPathMaxNeighbors": 2,
        "RGBD/ProximityAngle": 0.0,
        "Mem/STMSize": 3,
        "Rtabmap/LoopThr": 1.0,
        "RGBD/AggressiveLoopThr": 1.0,
    }
)


def run(params: Params, path: Path | None = None, count: int = 9) -> tuple[Slam, list[Update]]:
    writer = None if path is None else MapWriter.create(path, params, seed=0, source="tour:")
    slam = Slam(params, writer)
    updates = fed(slam, there_and_back(count))
    slam.close()
    return slam, updates


@pytest.fixture(scope="module")
def clouds(tmp_path_factory: pytest.TempPathFactory) -> tuple[Slam, list[Update], MapReader]:
    path = tmp_path_factory.mktemp("clouds") / "map.db"
    slam, updates = run(CLOUDS.changed({"Rtabmap/MemoryThr": 6}), path)
    return slam, updates, MapReader(path)


def test_paths_near_by_are_joined_by_their_clouds_and_the_map_is_right(
    clouds: tuple[Slam, list[Update], MapReader],
) -> None:
    slam, updates, _ = clouds
    candidates = [c for update in updates for c in update.candidates if c.by_scans]
    accepted = [c for c in candidates if c.refusal is None]
    assert len(accepted) >= 3
    for candidate in accepted:
        T_world = [there_and_back(9)[i - 1].T_world_base for i in (candidate.from_id, candidate.to_id)]
        assert T_world[0] is not None
        assert T_world[1] is not None
        assert candidate.T_from_to is not None
        assert translation_norm(between(between(T_world[0], T_world[1]), candidate.T_from_to)) < 0.08
    added = sum(u.statistics["Proximity/Space_detections_added_icp_multi/"] for u in updates)
    assert added == len(accepted)
    checked = sum(u.statistics["Proximity/Space_scan_paths_checked/"] for u in updates)
    assert checked == len(candidates)
    error = ate_rmse_m(slam)
    assert error is not None
    assert error < 0.05


def test_refined_links_are_the_graph_s_and_say_what_they_came_to(
    clouds: tuple[Slam, list[Update], MapReader],
) -> None:
    slam, updates, _ = clouds
    links = {link.from_id: link for link in slam.graph.links.values() if link.type is LinkType.NEIGHBOR}
    accepted = 0
    for update in updates[1:]:
        assert update.node is not None
        found = {k.split("/", 1)[1]: v for k, v in update.statistics.items() if k.startswith("NeighborLinkRefining/")}
        assert found.keys() == {
            "Accepted/", "Inliers/", "Variance/", "Pts/",
            "ICP_inliers_ratio/", "ICP_translation/m", "ICP_rotation/rad", "ICP_complexity/",
        }  # fmt: skip
        link = links[update.node.id]
        odometry = between(slam.graph.T_odom[link.from_id], slam.graph.T_odom[link.to_id])
        assert link.T_from_to is not None
        same = np.allclose(link.T_from_to, odometry, atol=1e-9)
        assert same == (found["Accepted/"] == 0)
        accepted += int(found["Accepted/"])
        if not same:
            moved = translation_norm(between(odometry, link.T_from_to))
            assert moved == pytest.approx(found["ICP_translation/m"], rel=1e-6)
    assert accepted >= 10


def test_clouds_are_in_ram_with_their_nodes_and_in_the_file_for_all(
    clouds: tuple[Slam, list[Update], MapReader],
) -> None:
    slam, updates, reader = clouds
    assert sum(update.statistics["Memory/Signatures_retrieved/"] for update in updates) > 0
    for node_id, node in slam.memory.nodes.items():
        stored = reader.scan(node_id)
        assert stored is not None
        assert node.scan is not None
        np.testing.assert_array_equal(node.scan.points_base, stored.points_base)
    assert slam.memory.ltm
    assert all(reader.scan(i) is not None for i in slam.memory.ltm)


def test_a_refined_step_moves_the_node_and_the_correction() -> None:
    slam = Slam(CLOUDS)
    fed(slam, sparse()[:2])
    link = slam.graph.links[1, 2]
    assert link.T_from_to is not None
    np.testing.assert_allclose(slam.graph.poses[2], slam.graph.poses[1] @ inverse(link.T_from_to), atol=1e-12)
    np.testing.assert_allclose(slam.graph.correction @ slam.graph.T_odom[2], slam.graph.poses[2], atol=1e-12)


def test_the_same_frames_give_the_same_map_bit_for_bit() -> None:
    first, second = run(CLOUDS, count=6)[0], run(CLOUDS, count=6)[0]
    for node_id, T in first.graph.poses.items():
        np.testing.assert_array_equal(T, second.graph.poses[node_id])


def test_without_icp_or_flow_nodes_keep_neither_clouds_nor_images() -> None:
    slam = Slam(EVERY)
    fed(slam, sparse()[:2])
    assert all(node.scan is None and node.images is None for node in slam.memory.nodes.values())
    flow = Slam(EVERY.changed({"Vis/CorType": 1, "RGBD/NeighborLinkRefining": True}))
    updates = fed(flow, sparse()[:3])
    assert all(node.scan is None and node.images is not None for node in flow.memory.nodes.values())
    assert updates[2].statistics["NeighborLinkRefining/Inliers/"] >= 20
