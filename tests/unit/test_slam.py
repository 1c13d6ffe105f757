"""The engine as a whole: what it keeps, how it begins anew, and what others see while it runs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from slam.database import MapReader, MapWriter
from slam.geometry import between, translation_norm
from slam.graph import PoseGraph
from slam.params import Params
from slam.slam import Slam
from slam.types import LinkType, Tier, Update
from tests.tours import EVERY, Mapped, blank, covered, dense, fed, mapped, sparse, there_and_back, truth


@pytest.fixture(params=[0, 25], ids=["all in working memory", "25 nodes in working memory"])
def tour(request: pytest.FixtureRequest) -> Mapped:
    return mapped(request.param)


def new_map(path: Path, params: Params = EVERY) -> Slam:
    return Slam(params, MapWriter.create(path, params, seed=0, source="tour:"), source="tour:")


def test_working_memory_stays_within_its_room() -> None:
    updates = mapped(25).updates
    sizes = [update.statistics["Memory/Working_memory_size/"] for update in updates]
    assert max(sizes) <= 25
    assert sizes[-1] >= 20
    assert mapped(25).slam.memory.ltm
    assert sum(update.statistics["Memory/Signatures_retrieved/"] for update in updates) > 10
    assert not mapped(0).slam.memory.ltm


def test_a_loop_hands_the_weight_on(tour: Mapped) -> None:
    for update in tour.updates:
        for candidate in update.candidates:
            if candidate.refusal is None and candidate.type is LinkType.GLOBAL_CLOSURE:
                assert tour.slam.memory.weights[candidate.to_id] == 0


def test_standing_still_adds_weight_and_no_nodes() -> None:
    slam = Slam(EVERY)
    still = [replace(sparse()[k // 4], index=k, stamp=1.0 * k) for k in range(24)]
    updates = fed(slam, still)
    assert [update.node is not None for update in updates] == [k % 4 == 0 for k in range(24)]
    assert len(slam.graph) == 6
    rehearsed = sum(update.statistics.get("Memory/Rehearsal_id/", 0) > 0 for update in updates)
    assert sum(slam.memory.weights.values()) == 18 + rehearsed, "one for each frame that looked like the last node"
    assert all(weight == 3 for weight in list(slam.memory.weights.values())[:-1]) or rehearsed
    words = set(np.concatenate([bag.words for bag in slam.memory.bags.values()]).tolist())
    assert set(slam.memory.dictionary.ids()) == words, "frames that were not kept leave no words"


def test_weights_are_handed_on_and_never_lost() -> None:
    slam = Slam(EVERY)
    way = there_and_back(16)
    doubled = [replace(way[k // 2], index=k, stamp=0.5 * k) for k in range(2 * len(way))]
    updates = fed(slam, doubled)
    assert any(link.type is LinkType.GLOBAL_CLOSURE for link in slam.graph.links.values())
    kept = sum(update.node is not None for update in updates)
    rehearsed = sum(update.statistics.get("Memory/Rehearsal_id/", 0) > 0 for update in updates)
    assert sum(slam.memory.weights.values()) == len(doubled) - kept + rehearsed


def test_time_sends_nodes_away_and_without_it_none_goes(tmp_path: Path) -> None:
    params = EVERY.changed({"Rtabmap/TimeThr": 0.001})
    slam = new_map(tmp_path / "map.db", params)
    updates = fed(slam, sparse()[:32])
    slam.close()
    assert slam.memory.ltm
    assert sum(update.statistics["Memory/Signatures_removed/"] for update in updates) >= len(slam.memory.ltm)
    patient = Slam(EVERY.changed({"Rtabmap/TimeThr": 1e6}))
    fed(patient, sparse()[:32])
    assert not patient.memory.ltm
    stored = {i: t for row in MapReader(tmp_path / "map.db").updates() for i, t in row.tiers.items()}
    assert {i for i, tier in stored.items() if tier is Tier.LTM} == slam.memory.ltm, "a replay can repeat it"


@pytest.mark.parametrize("size", [1, 3])
def test_short_term_memory_has_its_size(size: int) -> None:
    slam = Slam(EVERY.changed({"Mem/STMSize": size, "Rtabmap/LoopThr": 0.0}))
    updates = fed(slam, sparse()[:12])
    assert all(update.statistics["Memory/Short_time_memory_size/"] <= size for update in updates)
    assert len(slam.memory.wm) == 12 - size


def test_every_node_knows_which_way_is_up_where_an_accelerometer_says_so(tmp_path: Path) -> None:
    slam = new_map(tmp_path / "map.db")
    frames = [replace(f, T_gravity_base=None) if k == 3 else f for k, f in enumerate(sparse()[:6])]
    fed(slam, frames)
    slam.close()
    assert [key[0] for key in slam.graph.constraints] == [1, 2, 3, 5, 6]
    again = PoseGraph.from_reader(MapReader(tmp_path / "map.db"))
    for key, link in slam.graph.constraints.items():
        T_gravity_base = frames[key[0] - 1].T_gravity_base
        assert T_gravity_base is not None and link.T_from_to is not None
        np.testing.assert_array_equal(link.T_from_to, T_gravity_base)
        stored = again.constraints[key].T_from_to
        assert stored is not None
        np.testing.assert_allclose(stored, T_gravity_base, atol=1e-6)


# Which frames become nodes.


def test_the_rate_goes_by_the_stamps_of_the_frames() -> None:
    slam = Slam(Params().changed({"RGBD/LinearUpdate": 0.0, "RGBD/AngularUpdate": 0.0, "Rtabmap/DetectionRate": 5.0}))
    updates = fed(slam, dense())
    assert [k for k, update in enumerate(updates) if update.node is not None] == list(range(0, 24, 3))
    assert len(slam.frames) == 24
    assert [frame.node_id for frame in slam.frames] == [1 + k // 3 for k in range(24)]
    assert all(update.T_map_base is not None for update in updates)


def test_a_clock_that_is_set_back_does_not_stop_the_map() -> None:
    slam = Slam(Params())
    early = [replace(frame, stamp=frame.stamp - 3600.0 * (k >= 4)) for k, frame in enumerate(sparse()[:8])]
    assert all(update.node is not None for update in fed(slam, early))


def test_frames_hang_on_their_node() -> None:
    slam = Slam(Params().changed({"Rtabmap/DetectionRate": 3.0}))
    fed(slam, dense())
    first = slam.frames[0]
    assert first.T_node_base is not None
    np.testing.assert_allclose(first.T_node_base, np.eye(4), atol=1e-12)
    for frame in slam.frames:
        assert frame.T_node_base is not None
        true = between(truth(dense())[0], truth(dense())[frame.index])
        found = between(slam.graph.poses[1], slam.graph.poses[frame.node_id] @ frame.T_node_base)
        assert translation_norm(between(true, found)) < 0.02


# Changing parameters while it runs.


def test_loops_stop_when_the_threshold_rises(tmp_path: Path) -> None:
    frames, slam = there_and_back(22), new_map(tmp_path / "map.db")
    before = fed(slam, frames[:34])
    assert slam.set_params({"Rtabmap/LoopThr": 1.0, "RGBD/ProximityBySpace": False}).Rtabmap.LoopThr == 1.0
    after = fed(slam, frames[34:])
    slam.close()
    assert any(c.refusal is None for update in before for c in update.candidates)
    assert not any(update.candidates for update in after)
    assert all(update.node is not None for update in after)
    changes = MapReader(tmp_path / "map.db").parameter_changes()
    assert [(c.node_id, c.name, c.value) for c in changes] == [
        (34, "Rtabmap/LoopThr", "1.0"),
        (34, "RGBD/ProximityBySpace", "false"),
    ]


def test_lost_frames_are_told_and_the_session_goes_on() -> None:
    slam = Slam(EVERY)
    updates = fed(slam, covered(sparse()[:12], [5]))
    assert [update.T_map_base is None for update in updates] == [k == 5 for k in range(12)]
    assert updates[5].node is None
    assert slam.frames[5].lost == "0 inliers, fewer than Vis/MinInliers 20"
    assert slam.frames[5].T_node_base is None
    assert set(slam.graph.map_ids.values()) == {0}
    assert len(slam.graph.links) == len(slam.graph) - 1


def restarted(path: Path | None) -> tuple[Slam, list[Update]]:
    """There and back with the lid on at the turn, where odometry begins anew."""
    params = EVERY.changed({"Odom/ResetCountdown": 2})
    slam = Slam(params) if path is None else new_map(path, params)
    way = there_and_back(22)
    return slam, fed(slam, [*way[:22], blank(way[21]), blank(way[22]), *way[23:]])


def test_a_restart_is_a_new_session_that_a_loop_joins(tmp_path: Path) -> None:
    slam, updates = restarted(tmp_path / "map.db")
    slam.close()
    ids = slam.graph.map_ids
    assert set(ids.values()) == {0, 1}
    assert all(ids[i] == 0 for i in range(1, 23))
    assert all(ids[i] == 1 for i in range(23, len(ids) + 1))
    assert (22, 23) not in slam.graph.links, "no odometry leads from one to the other"
    first = next(k for k, update in enumerate(updates) if update.optimized)
    assert first > 23
    assert updates[first].candidates[0].type is LinkType.GLOBAL_CLOSURE
    assert slam.graph.component(1) == slam.graph.poses.keys()
    T_world = truth(there_and_back(22))
    true, found = between(T_world[0], T_world[-1]), between(slam.graph.poses[1], slam.graph.poses[len(ids)])
    assert translation_norm(between(true, found)) < 0.1, "both are the same place"


def test_the_file_takes_a_restart(tmp_path: Path) -> None:
    slam, _ = restarted(tmp_path / "map.db")
    slam.close()
    reader = MapReader(tmp_path / "map.db")
    sessions = reader.sessions()
    assert [(session.map_id, session.nodes, session.clean, session.source) for session in sessions] == [
        (0, 22, True, "tour:"),
        (1, len(slam.graph) - 22, True, "tour:"),
    ]
    assert reader.nodes().map_ids.tolist() == list(slam.graph.map_ids.values())
    linked = {link.pair for link in reader.links() if link.type is not LinkType.GRAVITY}
    assert linked == slam.graph.links.keys()
    assert [frame.lost != "" for frame in reader.trajectory()] == [k in (22, 23) for k in range(44)]


def test_a_moment_without_depth_is_no_restart() -> None:
    frames = [replace(f, depth_m=np.zeros_like(f.depth_m)) if k in (4, 5) else f for k, f in enumerate(sparse()[:9])]
    slam = Slam(EVERY)
    fed(slam, frames)
    assert set(slam.graph.map_ids.values()) == {0}
    assert slam.graph.component(1) == slam.graph.poses.keys()


# Reading and ending.


def test_others_read_while_it_runs(tmp_path: Path) -> None:
    slam = new_map(tmp_path / "map.db")
    reader = MapReader(tmp_path / "map.db")
    for k, frame in enumerate(sparse()[:6]):
        slam.process(frame)
        assert reader.node_ids().tolist() == list(range(1, k + 2))
        assert reader.poses().keys() == slam.graph.poses.keys()
        assert [row.id for row in reader.updates(after=k)] == [k + 1]
        assert reader.image_bgr(k + 1).shape == (240, 320, 3)
    assert not reader.info().clean
    slam.close()
    assert reader.info().clean


def test_an_engine_without_a_file_closes_too() -> None:
    slam = Slam(EVERY)
    fed(slam, sparse()[:2])
    slam.close()


def test_frames_since_the_last_node_are_stored_at_the_end(tmp_path: Path) -> None:
    params = Params().changed({"Rtabmap/DetectionRate": 1.0})
    slam = new_map(tmp_path / "map.db", params)
    fed(slam, dense())
    slam.close()
    assert len(MapReader(tmp_path / "map.db").trajectory()) == 24


def test_the_first_frames_may_show_nothing() -> None:
    slam = Slam(EVERY)
    updates = fed(slam, covered(sparse()[:4], [0, 1]))
    assert [update.node is not None for update in updates] == [False, False, True, True]
    assert [frame.node_id for frame in slam.frames] == [0, 0, 1, 2]
    assert set(slam.graph.map_ids.values()) == {0}
