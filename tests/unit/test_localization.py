"""Localising in a finished map: where the robot is, how sure that is, and that the map stays as it was."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from slam.database import MapReader, MapWriter
from slam.geometry import between, translation_norm
from slam.localization import Localization
from slam.memory.past import recall
from slam.params import Value
from slam.types import UNKNOWN_VARIANCE, Frame, LinkType, Update
from tests.tours import EVERY, blank, fed, saved, sparse

LOCALIZE = EVERY.changed({"Mem/IncrementalMemory": False})


def opened(path: Path, *, write: bool = False, **changes: Value) -> Localization:
    params = LOCALIZE.changed({name.replace("_", "/"): value for name, value in changes.items()})
    past = recall(MapReader(path), params, seed=0)
    if not write:
        return Localization(params, past)
    writer = MapWriter.open(path)
    writer.start_session(params, seed=0, source="again")
    return Localization(params, past, writer)


def off_m(slam: Localization, frame: Frame, update: Update) -> float:
    """How far the pose in the map is from the truth, metres; the map begins at the tour's first frame."""
    T_world_first = sparse()[0].T_world_base
    assert T_world_first is not None
    assert frame.T_world_base is not None
    assert update.T_map_base is not None
    true, found = between(T_world_first, frame.T_world_base), between(slam.graph.poses[1], update.T_map_base)
    return translation_norm(between(true, found))


def test_a_robot_that_starts_elsewhere_finds_itself() -> None:
    slam, frames = opened(saved(0)), sparse()[6:12]
    for frame in frames:
        update = slam.process(frame)
        assert slam.localized
        assert off_m(slam, frame, update) < 0.05
        assert update.covariance is not None
        assert 1e-5 < np.sqrt(update.covariance.diagonal()[:3].max()) < 0.05
        assert np.linalg.eigvalsh(update.covariance).min() > 0
    error = slam.ate_m()
    assert error is not None
    assert error < 0.03
    assert all(frame.covariance is not None for frame in slam.frames)


def test_between_updates_the_pose_grows_less_certain() -> None:
    slam = opened(saved(0), Rtabmap_DetectionRate=0.5)
    first, later = fed(slam, sparse()[6:8])
    assert first.covariance is not None
    assert later.covariance is not None
    assert later.covariance[0, 0] > first.covariance[0, 0]
    assert off_m(slam, sparse()[7], later) < 0.05


def test_carried_away_with_closed_eyes_it_finds_itself_again() -> None:
    slam = opened(saved(0), Odom_ResetCountdown=1)
    way = [*sparse()[1:4], blank(sparse()[4]), *sparse()[13:17]]
    updates = fed(slam, way)
    assert updates[3].T_map_base is None
    assert slam.frames[3].lost
    for frame, update in zip(way[4:], updates[4:], strict=True):
        assert off_m(slam, frame, update) < 0.1
    assert updates[4].candidates[0].type is LinkType.GLOBAL_CLOSURE


def test_where_nothing_is_known_the_pose_is_a_guess() -> None:
    slam = opened(saved(0, 8))
    updates = fed(slam, sparse()[30:34])
    assert not slam.localized
    for update in updates:
        assert update.covariance is not None
        assert (update.covariance.diagonal() == UNKNOWN_VARIANCE).all()
    assert all(frame.T_node_base is None and "not localised" in frame.lost for frame in slam.frames)
    assert slam.ate_m() is None


@pytest.mark.parametrize("origin", [False, True])
def test_the_guess_is_the_last_pose_or_the_first_node(origin: bool) -> None:
    slam, reader = opened(saved(0, 8), RGBD_StartAtOrigin=origin), MapReader(saved(0, 8))
    update = slam.process(sparse()[30])
    expected = reader.poses()[1] if origin else reader.last_pose()
    assert expected is not None
    assert update.T_map_base is not None
    np.testing.assert_allclose(update.T_map_base, expected, atol=1e-6)


def test_the_map_is_not_changed_by_a_byte_when_it_is_only_read(tmp_path: Path) -> None:
    path = Path(shutil.copy(saved(0), tmp_path))
    before = path.read_bytes()
    slam = opened(path)
    fed(slam, sparse()[3:9])
    slam.close()
    assert path.read_bytes() == before
    assert [part.name for part in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("keep", [False, True])
def test_the_map_stays_what_it_was(tmp_path: Path, keep: bool) -> None:
    path = Path(shutil.copy(saved(4), tmp_path))
    before = MapReader(path)
    ids, poses, left, links = before.node_ids(), before.poses(), before.memory_ids(), before.links()
    slam = opened(path, write=True, Mem_LocalizationDataSaved=keep)
    last = fed(slam, sparse()[3:9])[-1]
    slam.close()
    after = MapReader(path)
    table = after.nodes()
    kept = table.weights > -9
    assert table.ids[kept].tolist() == ids.tolist()
    assert (~kept).sum() == (6 if keep else 0)
    assert len(after.links()) == len(links)
    for node_id, T in poses.items():
        np.testing.assert_array_equal(after.poses()[node_id], T)
    for now, then in zip(after.memory_ids(), left, strict=True):
        np.testing.assert_array_equal(now, then)
    stored = after.last_pose()
    assert stored is not None
    assert last.T_map_base is not None
    np.testing.assert_allclose(stored, last.T_map_base, atol=1e-5)
    assert len(after.trajectory()) == 18 + 6
    assert [session.source for session in after.sessions()] == ["there", "again"]


def test_nodes_in_long_term_memory_are_found_again() -> None:
    slam = opened(saved(4))
    assert slam.memory.ltm
    away = set(slam.memory.ltm)
    fed(slam, sparse()[17:1:-1])
    assert slam.localized
    assert away - slam.memory.ltm


def test_what_disagrees_with_the_last_poses_is_refused() -> None:
    slam = opened(saved(0), RGBD_OptimizeMaxError=1e-6)
    frames = sparse()[3:7]
    updates = fed(slam, frames)
    refused = [c.refusal for update in updates for c in update.candidates if c.refusal is not None]
    assert any(refusal.test == "RGBD/OptimizeMaxError" for refusal in refused)
    free = opened(saved(0), RGBD_OptimizeMaxError=1e-6, RGBD_MaxOdomCacheSize=1)
    fed(free, frames)
    assert free.localized


def test_the_dictionary_and_the_graph_are_left_as_they_were() -> None:
    slam = opened(saved(0))
    words, poses = slam.memory.dictionary.ids(), dict(slam.graph.poses)
    fed(slam, sparse()[4:8])
    assert slam.memory.dictionary.ids() == words
    assert slam.graph.poses.keys() == poses.keys()
    assert all(slam.graph.poses[i] is T for i, T in poses.items())
    assert not slam.memory.stm
