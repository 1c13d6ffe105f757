"""Parameters that are tried on a map: its replay as it was, its replay with the changes, and both compared."""

from __future__ import annotations

from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from shutil import copyfile

import numpy as np
import pytest

from slam.database import MapReader, MapWriter
from slam.errors import DatabaseError, ParameterError
from slam.geometry import translation_norm
from slam.params import Params, Value
from slam.tools.kept import keep
from slam.tools.outcome import outcome
from slam.tools.reprocess import Request, reprocess
from slam.tools.trial import Comparison, carry_out
from slam.tools.wanted import Wanted, check
from tests.tours import EVERY, mapped, saved

TOO_MANY = 5000


def tried(path: Path, folder: Path, changes: Mapping[str, Value]) -> tuple[Comparison, list[tuple[float, str]]]:
    told: list[tuple[float, str]] = []
    wanted = Wanted(path, changes, {})
    return carry_out(wanted, folder / "base.db", folder / "tried.db", lambda *said: told.append(said)), told


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("trial")


@pytest.fixture(scope="module")
def strict(folder: Path) -> tuple[Comparison, list[tuple[float, str]]]:
    """The tour with its loops, as if far more inliers were asked for than a node has."""
    return tried(mapped(0).path, folder, {"Vis/MinInliers": TOO_MANY})


def test_both_replays_are_compared_by_the_nodes_of_the_map(strict: tuple[Comparison, list[tuple[float, str]]]) -> None:
    found, told = strict
    was, base, with_changes = found.original, found.baseline, found.tried
    assert was.nodes == base.nodes == with_changes.nodes == len(found.old_ids)
    assert was.poses.keys() == base.poses.keys() == with_changes.poses.keys()
    assert base.loops and len(was.loops.keys() & base.loops.keys()) >= 0.8 * len(was.loops.keys() | base.loops.keys())
    assert found.unlike == len(was.loops.keys() ^ base.loops.keys())
    assert not with_changes.loops and not found.came and found.gone.keys() == base.loops.keys()
    assert any("Vis/MinInliers" in why for why in found.gone.values())
    assert base.ate_m is not None and with_changes.ate_m is not None and with_changes.ate_m > base.ate_m
    far = max(translation_norm(np.linalg.inv(was.poses[i]) @ base.poses[i]) for i in was.poses)
    assert found.drift_m == pytest.approx(far) and found.drift_m < 0.05
    assert base.ids.tolist() == with_changes.ids.tolist() and np.isfinite(with_changes.update_ms).all()
    shares = [share for share, _ in told]
    assert shares == sorted(shares) and shares[-1] == 1.0 and len(shares) == was.nodes + base.nodes


def test_the_replay_as_it_was_serves_the_next_trial_and_the_map_stays_as_it_is(
    strict: tuple[Comparison, list[tuple[float, str]]], folder: Path
) -> None:
    bytes_before = sha256(mapped(0).path.read_bytes()).digest()
    made = (folder / "base.db").stat().st_mtime_ns
    found, told = tried(mapped(0).path, folder, {"Rtabmap/MemoryThr": 25})
    assert (folder / "base.db").stat().st_mtime_ns == made and len(told) == found.tried.nodes
    assert found.baseline.loops.keys() == strict[0].baseline.loops.keys()
    assert not found.baseline.transferred and found.baseline.ltm_end == 0
    assert found.tried.transferred and found.tried.ltm_end and np.nanmax(found.tried.wm) < np.nanmax(found.baseline.wm)
    assert sha256(mapped(0).path.read_bytes()).digest() == bytes_before


def test_images_are_decoded_only_where_a_change_asks_for_other_key_points(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[int] = []
    decode = MapReader.image_bgr
    monkeypatch.setattr(MapReader, "image_bgr", lambda self, i: seen.append(i) or decode(self, i))
    for changes in ({"Mem/STMSize": 4, "RGBD/OptimizeMaxError": 1.0}, {"Kp/MaxFeatures": 100}):
        assert not tried(saved(0), tmp_path, changes)[0].images and not seen
    found, _ = tried(saved(0), tmp_path, {"GFTT/MinDistance": 12.0})
    assert "GFTT/MinDistance" in found.images and set(seen) == set(found.original.poses)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"Odom/Strategy": 1}, "tracked"),
        ({"Vis/MinInliers": EVERY.Vis.MinInliers}, "nothing would change"),
        ({"Mem/IncrementalMemory": False}, "makes one"),
        ({"Rtabmap/LoopThr": 3.0}, "Rtabmap/LoopThr"),
        ({"Rtabmap/Nothing": 3.0}, "Rtabmap/Nothing"),
    ],
)
def test_what_a_replay_cannot_tell_is_refused(changes: Mapping[str, Value], said: str) -> None:
    with pytest.raises(ParameterError, match=said):
        check(Wanted(saved(0), changes, {}))


def test_values_in_force_that_the_file_does_not_tell_are_those_of_both_replays(tmp_path: Path) -> None:
    base: dict[str, Value] = {"Mem/STMSize": 3, "Mem/IncrementalMemory": False, "RGBD/LinearUpdate": 50.0}
    wanted = Wanted(saved(0), {"Vis/MinInliers": 30}, base)
    found = carry_out(wanted, tmp_path / "base.db", tmp_path / "tried.db", lambda *_: None)
    assert found.baseline.nodes == found.tried.nodes == found.original.nodes
    assert found.baseline.stm_max == found.tried.stm_max == 3 and found.original.stm_max == EVERY.Mem.STMSize


def test_a_trial_that_is_kept_is_a_whole_map_with_the_images_and_its_parameters(tmp_path: Path) -> None:
    found, _ = tried(saved(0), tmp_path, {"Mem/STMSize": 4, "Rtabmap/DetectionRate": 1.0})
    keep(tmp_path / "tried.db", found.old_ids, saved(0), tmp_path / "kept.db")
    kept, original = MapReader(tmp_path / "kept.db"), MapReader(saved(0))
    for new_id, old_id in found.old_ids.items():
        assert kept.image(new_id) == original.image(old_id) and kept.depth(new_id) == original.depth(old_id)
    texts = kept.parameters()
    assert texts["Mem/STMSize"] == "4" and texts["Rtabmap/DetectionRate"] == "1.0"
    assert texts["RGBD/LinearUpdate"] == original.parameters()["RGBD/LinearUpdate"]
    assert outcome(kept, found.old_ids).poses.keys() == found.tried.poses.keys()
    with pytest.raises(DatabaseError, match="exists already"):
        keep(tmp_path / "tried.db", found.old_ids, saved(0), tmp_path / "kept.db")
    with pytest.raises(DatabaseError, match="another map"):
        keep(tmp_path / "tried.db", {new: old + 1 for new, old in found.old_ids.items()}, saved(0), tmp_path / "no.db")
    assert not (tmp_path / "no.db").exists()


def test_parameters_that_are_changed_are_those_of_the_next_session(tmp_path: Path) -> None:
    copyfile(saved(0), path := tmp_path / "map.db")
    before = MapReader(path).parameters()
    with MapWriter.open(path) as writer:
        writer.change_parameters({"Vis/MinInliers": 40})
        with pytest.raises(ParameterError):
            writer.change_parameters({"Vis/MinInliers": -1, "Mem/STMSize": 3})
    assert MapReader(path).parameters() == {**before, "Vis/MinInliers": "40"}
    assert [(c.name, c.value) for c in MapReader(path).parameter_changes()] == [("Vis/MinInliers", "40")]
    assert Params().Vis.MinInliers != 40


def test_nodes_that_come_after_the_last_one_asked_for_are_left_out(tmp_path: Path) -> None:
    """A map that is being made goes on growing while it is replayed."""
    told: list[int] = []
    request = Request(inputs=[saved(0)], output=tmp_path / "some.db", last_id=9)
    summary = reprocess(request, lambda *said: told.append(said[2]))
    assert summary["nodes"] == 9 and set(told) == {9}
    some = outcome(MapReader(saved(0)), {i: i for i in range(1, 10)})
    assert some.nodes == 9 and list(some.poses) == some.ids.tolist() == list(range(1, 10))
