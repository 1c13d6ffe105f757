"""What the file says is what the engine knew: poses, words, the path, candidates, statistics."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slam.database import MapReader, MapWriter
from slam.params import Params
from slam.slam import Slam
from slam.types import LinkType, Tier
from tests.tours import EVERY, Mapped, mapped, sparse, truth

#: Statistics that RTAB-Map does not have: its users see them as somebody's own.
OWN = {"Memory/Long_term_memory_size/"}
#: RTAB-Map's names (Statistics.h of 0.23, and what its odometry adds) that are in use here.
RTABMAP = {
    "Loop": "Id/ Map_id/ Accepted_hypothesis_id/ RejectedHypothesis/ Highest_hypothesis_id/ Highest_hypothesis_value/ "
    "Vp_hypothesis/ Visual_matches/ Visual_inliers/ Visual_words/ Optimization_max_error/m "
    "Optimization_max_error_ratio/ Optimization_max_ang_error/deg Optimization_max_ang_error_ratio/ "
    "Optimization_error/ Optimization_iterations/ MapToOdom_norm/m MapToOdom_angle/deg MapToOdom_x/m MapToOdom_y/m "
    "MapToOdom_z/m MapToOdom_roll/deg MapToOdom_pitch/deg MapToOdom_yaw/deg MapToBase_x/m MapToBase_y/m MapToBase_z/m "
    "MapToBase_roll/deg MapToBase_pitch/deg MapToBase_yaw/deg",
    "Proximity": "Space_visual_paths_checked/ Space_scan_paths_checked/ Space_detections_added_visually/ "
    "Space_detections_added_icp_multi/ Space_last_detection_id/",
    "Memory": "Short_time_memory_inter_size/ Working_memory_inter_size/ Short_time_memory_size/ "
    "Working_memory_size/ Local_graph_size/ Signatures_removed/ "
    "Immunized_globally/ Immunized_locally/ Immunized_locally_max/ "
    "Signatures_retrieved/ Rehearsal_id/ Rehearsal_sim/ Distance_travelled/m Odometry_variance_lin/ "
    "Odometry_variance_ang/",
    "Keypoint": "Dictionary_size/words Current_frame/words",
    "Odometry": "Features/ Inliers/ KeyFrameAdded/ TotalTime/ms",
    "Timing": "Memory_update/ms Neighbor_link_refining/ms Likelihood_computation/ms Posterior_computation/ms "
    "Reactivation/ms Hypotheses_validation/ms Proximity_by_space/ms Map_optimization/ms Forgetting/ms Total/ms",
    "TimingMem": "Occupancy_grid/ms",
}


@pytest.fixture(params=[0, 25], ids=["all in working memory", "25 nodes in working memory"])
def tour(request: pytest.FixtureRequest) -> Mapped:
    return mapped(request.param)


def new_map(path: Path, params: Params = EVERY) -> Slam:
    return Slam(params, MapWriter.create(path, params, seed=0, source="tour:"), source="tour:")


# What the file says is what the engine knew.


def test_the_file_has_the_poses_and_links_of_the_engine(tour: Mapped) -> None:
    reader, graph = MapReader(tour.path), tour.slam.graph
    poses = reader.poses()
    assert poses.keys() == graph.poses.keys()
    for node_id, T in graph.poses.items():
        np.testing.assert_allclose(poses[node_id], T, atol=1e-5)  # single precision, as in RTAB-Map's files
    links = {link.pair: link for link in reader.links() if link.type is not LinkType.GRAVITY}
    assert links.keys() == graph.links.keys()
    for pair, link in graph.links.items():
        assert (links[pair].from_id, links[pair].type) == (link.from_id, link.type)
        stored = links[pair].T_from_to
        assert stored is not None
        assert link.T_from_to is not None
        np.testing.assert_allclose(stored, link.T_from_to, atol=1e-5)
        np.testing.assert_allclose(links[pair].information, link.information, rtol=1e-6)


def test_the_file_has_the_nodes_weights_and_truth_of_the_engine(tour: Mapped) -> None:
    table, slam = MapReader(tour.path).nodes(), tour.slam
    assert dict(zip(table.ids.tolist(), table.weights.tolist(), strict=True)) == slam.memory.weights
    assert set(table.map_ids.tolist()) == {0}
    for row, node_id in enumerate(table.ids.tolist()):
        np.testing.assert_allclose(table.T_odom[row], slam.graph.T_odom[node_id], atol=1e-5)
    np.testing.assert_allclose(table.T_world, truth(sparse()), atol=1e-5)
    assert table.stamps.tolist() == [frame.stamp for frame in sparse()]


def test_the_file_has_the_words_of_the_nodes_in_ram(tour: Mapped) -> None:
    reader, memory = MapReader(tour.path), tour.slam.memory
    node_ids, word_ids = reader.memory_ids()
    assert node_ids.tolist() == sorted(memory.nodes)
    assert word_ids.tolist() == memory.dictionary.ids()
    stored = reader.words(memory.dictionary.ids())
    np.testing.assert_array_equal(stored.descriptors, memory.dictionary.descriptors(stored.ids))
    for node_id, node in memory.nodes.items():
        features, words = reader.features(node_id)
        np.testing.assert_array_equal(words, node.word_ids)
        np.testing.assert_array_equal(features.descriptors, node.features.descriptors)
        np.testing.assert_array_equal(features.pixels, node.features.pixels)
        np.testing.assert_array_equal(features.points_base, node.features.points_base)
        assert set(words[words > 0].tolist()) <= set(word_ids.tolist()), "RTAB-Map loads no other words"


def test_the_file_has_the_whole_path(tour: Mapped) -> None:
    stored = MapReader(tour.path).trajectory()
    assert len(stored) == len(sparse())
    for frame, made in zip(stored, tour.slam.frames, strict=True):
        assert (frame.index, frame.stamp, frame.node_id) == (made.index, made.stamp, made.node_id)
        assert (frame.inliers, frame.lost) == (made.inliers, made.lost)
        assert frame.T_node_base is not None
        assert made.T_node_base is not None
        np.testing.assert_allclose(frame.T_node_base, made.T_node_base, atol=1e-6)


def test_the_file_has_candidates_beliefs_and_statistics(tour: Mapped) -> None:
    reader = MapReader(tour.path)
    stored = [row.candidate for row in reader.candidates()]
    assert [(c.from_id, c.to_id, c.type, c.matches, c.inliers, c.refusal) for c in stored] == [
        (c.from_id, c.to_id, c.type, c.matches, c.inliers, c.refusal) for c in tour.candidates
    ]
    rows = reader.updates()
    assert [row.id for row in rows] == list(range(1, len(sparse()) + 1))
    table = reader.statistics()
    for update, row in zip(tour.updates, rows, strict=True):
        assert dict(row.tiers) == dict(update.tiers)
        assert row.optimized == update.optimized
        assert row.weight == update.weight
        assert update.posterior is not None
        assert row.value == pytest.approx(update.posterior.value)
        for name, value in update.statistics.items():
            assert table.values[name][row.id - 1] == pytest.approx(value, rel=1e-5, abs=1e-6), (
                name
            )  # six digits, as RTAB-Map
    states = reader.wm_states()
    assert states[len(sparse())].tolist() == sorted(tour.slam.memory.nodes)


def test_the_session_is_closed_in_order(tour: Mapped) -> None:
    info = MapReader(tour.path).info()
    assert info.clean
    assert info.seeds == (3,)
    assert info.sources == ("tour:",)
    assert (info.nodes, info.sessions) == (len(sparse()), 1)
    assert sorted(p.name for p in tour.path.parent.iterdir() if p.suffix != ".lock") == [tour.path.name]


def test_all_statistics_have_names_that_rtabmap_knows(tour: Mapped) -> None:
    known = {f"{group}/{name}" for group, names in RTABMAP.items() for name in names.split()}
    found = {name for update in tour.updates for name in update.statistics}
    assert found - known == OWN
    assert known - found == set(), "listed, but never given"
    assert all(np.isfinite(value) for update in tour.updates for value in update.statistics.values())


def test_rtabmap_writes_the_same_names(shared_data: Path) -> None:
    reader = MapReader(shared_data / "rtabmap_db" / "cpp_0.23.8_toyroom.db")
    theirs = set(reader.statistics(reader.node_ids()[-3:].tolist()).values)
    assert set(mapped(0).updates[-1].statistics) - theirs == OWN


# Memory.


def test_tiers_told_by_updates_are_the_tiers_of_memory(tour: Mapped) -> None:
    tiers: dict[int, Tier] = {}
    for update in tour.updates:
        tiers |= update.tiers
    memory = tour.slam.memory
    assert tiers == {i: memory.tier(i) for i in tour.slam.graph.poses}
    assert list(memory.stm) == list(range(len(sparse()) - 9, len(sparse()) + 1))
