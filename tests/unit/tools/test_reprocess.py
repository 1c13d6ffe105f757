"""Maps that are made again of map files."""

from __future__ import annotations

import sqlite3
from dataclasses import replace
from pathlib import Path
from shutil import copyfile

import numpy as np
import pytest

from slam.database import JournalEntry, MapReader, MapWriter
from slam.errors import DatabaseError, ParameterError
from slam.graph.graph import PoseGraph
from slam.params import Params
from slam.tools.reprocess import Request, Whose, reprocess
from slam.types import Link, LinkType
from tests.tours import mapped, saved
from tests.unit.database.old_files import Version, write_old

BEST, VALUE = "Loop/Highest_hypothesis_id/", "Loop/Highest_hypothesis_value/"


def again(source: Path, folder: Path, **options: object) -> tuple[MapReader, dict[str, object]]:
    output = folder / "again.db"
    summary = reprocess(Request(inputs=[source], output=output, **options))  # type: ignore[arg-type]
    return MapReader(output), summary


def hand_link(reader: MapReader, from_id: int, to_id: int) -> Link:
    poses = reader.poses()
    T = np.linalg.inv(poses[from_id]) @ poses[to_id]
    return Link(from_id, to_id, LinkType.USER_CLOSURE, T, 400.0 * np.eye(6))


def test_an_unchanged_replay_has_the_same_nodes_with_the_same_data_words_and_loops(tmp_path: Path) -> None:
    old = MapReader(mapped(0).path)
    new, summary = again(old.path, tmp_path)
    before, after = old.nodes(), new.nodes()
    assert after.ids.tolist() == before.ids.tolist() and summary["not_in_the_map"] == 0
    assert np.array_equal(after.stamps, before.stamps) and np.array_equal(after.T_odom, before.T_odom)
    assert np.array_equal(after.T_world, before.T_world, equal_nan=True)
    for node_id in (1, 40, int(before.ids[-1])):
        assert new.image(node_id) == old.image(node_id) and new.depth(node_id) == old.depth(node_id)
        assert sorted(new.features(node_id)[1][new.features(node_id)[1] > 0]) == sorted(
            old.features(node_id)[1][old.features(node_id)[1] > 0]
        )
    loops = [{link.pair for link in reader.links() if link.type.is_loop} for reader in (old, new)]
    assert loops[0] and len(loops[0] & loops[1]) >= 0.8 * len(loops[0] | loops[1])


def test_the_covariance_of_odometry_is_that_of_the_links(tmp_path: Path) -> None:
    old = MapReader(saved(0))
    new, _ = again(old.path, tmp_path)
    known = {link.pair: link for link in old.links() if link.type is LinkType.NEIGHBOR}
    for link in (link for link in new.links() if link.type is LinkType.NEIGHBOR):
        np.testing.assert_allclose(link.information, known[link.pair].information, rtol=1e-6)


@pytest.mark.parametrize("name", ["cpp_0.23.8_toyroom.db", "cpp_0.23.8_tum_fr1_xyz_excerpt.db"])
def test_hypotheses_are_those_of_rtabmap(shared_data: Path, tmp_path: Path, name: str) -> None:
    """The same best place, and nearly the same value, in at least 90 % of the updates that pass LoopThr."""
    old = MapReader(shared_data / "rtabmap_db" / name)
    new, _ = again(old.path, tmp_path)
    ours, theirs = new.statistics(), old.statistics()
    kept = old.nodes().ids[old.nodes().weights >= 0].tolist()
    new_id = dict(zip(kept, new.nodes().ids.tolist(), strict=True))
    same, passed = 0, 0
    for row, node_id in enumerate(theirs.ids.tolist()):
        value, best = theirs.values[VALUE][row], int(theirs.values[BEST][row])
        if node_id in new_id and value >= Params().Rtabmap.LoopThr:
            here = ours.ids.tolist().index(new_id[node_id])
            passed += 1
            same += int(ours.values[BEST][here]) == new_id[best]
            assert ours.values[VALUE][here] == pytest.approx(value, abs=0.01)
    assert passed >= 7 and same >= 0.9 * passed


def test_what_people_did_is_done_again(tmp_path: Path) -> None:
    source = tmp_path / "judged.db"
    copyfile(mapped(0).path, source)
    old = MapReader(source)
    loops = [link for link in old.links() if link.type.is_loop]
    added = hand_link(old, 30, 5)
    with MapWriter.open(source) as writer:
        for action, link, then in (("reject", loops[0], None), ("approve", loops[1], loops[1])):
            entry = JournalEntry(
                action=action,
                from_id=link.from_id,
                to_id=link.to_id,
                author="Ada",
                time=5.0,
                link_before=link,
                link_after=then,
            )
            removed = [(link.from_id, link.to_id)] if then is None else []
            writer.append_decision(entry, remove=removed, poses={})
        entry = JournalEntry(action="add", from_id=30, to_id=5, author="Bob", time=6.0, link_after=added)
        writer.append_decision(entry, add=[added], poses={})
        writer.label_nodes({12: "kitchen"})
    new, summary = again(source, tmp_path)
    graph = PoseGraph.from_reader(new)
    assert summary["by_hand"] == {"decisions": 3, "links": 1, "labels": 1} and summary["lost"] == []
    assert loops[0].pair not in graph.links and loops[1].pair in graph.links
    found = graph.links[5, 30]
    assert found.type is LinkType.USER_CLOSURE
    np.testing.assert_allclose(found.T_from_to, added.T_from_to, atol=1e-6)
    assert [(e.action, e.author, e.time) for e in new.journal()] == [
        ("reject", "Ada", 5.0),
        ("approve", "Ada", 5.0),
        ("add", "Bob", 6.0),
    ]
    assert new.nodes().labels[11] == "kitchen" and new.nodes().labels[0] == "map0"
    assert new.grid() is not None


def test_several_files_become_sessions_of_one_map(tmp_path: Path) -> None:
    reprocess(Request(inputs=[saved(0), saved(0)], output=tmp_path / "both.db"))
    both = MapReader(tmp_path / "both.db")
    assert [session.nodes for session in both.sessions()] == [18, 18]
    assert any(link.type.is_loop and min(link.pair) <= 18 < max(link.pair) for link in both.links())


def test_own_odometry_tracks_the_stored_images(tmp_path: Path) -> None:
    source = MapReader(saved(0))
    new, summary = again(source.path, tmp_path, odometry=Whose.OWN)
    assert summary["lost_frames"] == 0 and len(new.nodes()) == len(source.nodes())
    assert summary["ate_rmse_m"] < 0.02  # type: ignore[operator]
    assert not np.allclose(new.nodes().T_odom[-1], source.nodes().T_odom[-1])


def test_another_detector_finds_key_points_anew(tmp_path: Path) -> None:
    new, summary = again(saved(0, 4), tmp_path, changes={"Vis/FeatureType": 2, "Kp/DetectorStrategy": 2})
    assert summary["features"] == "own"
    assert not np.array_equal(new.features(2)[0].pixels, MapReader(saved(0, 4)).features(2)[0].pixels)
    with pytest.raises(ParameterError, match="Kp/DetectorStrategy asks for other key points"):
        again(saved(0, 4), tmp_path, changes={"Kp/DetectorStrategy": 2}, features=Whose.STORED, force=True)


def test_nodes_without_images_keep_their_key_points(tmp_path: Path) -> None:
    source = tmp_path / "bare.db"
    copyfile(saved(0, 6), source)
    with sqlite3.connect(source) as connection:
        connection.execute("UPDATE Data SET image = NULL, depth = NULL WHERE id = 3")
    new, _ = again(source, tmp_path)
    assert new.node(3).image_bytes == new.node(3).depth_bytes == 0
    assert new.node(3).words == MapReader(source).node(3).words > 0
    assert new.node(3).has_grid


@pytest.mark.parametrize("version", [(0, 6, 0), (0, 10, 7), (0, 17, 0)])
def test_old_files_come_up_to_todays_schema(tmp_path: Path, version: Version) -> None:
    old = MapReader(write_old(tmp_path / "old.db", version))
    new, summary = again(old.path, tmp_path)
    assert new.info().version == "0.20.0" and summary["nodes"] == 3
    assert new.image(1) == old.image(1) and new.camera(1).fx == old.camera(1).fx
    scans = new.scan(1), old.scan(1)
    assert scans[0] is not None and scans[1] is not None
    np.testing.assert_allclose(scans[0].points_base, scans[1].points_base, atol=1e-6)


def test_no_output_is_overwritten_and_no_input_touched(tmp_path: Path) -> None:
    source = saved(0, 4)
    before = source.read_bytes()
    again(source, tmp_path)
    with pytest.raises(DatabaseError, match=r"exists already: .*--force"):
        again(source, tmp_path)
    with pytest.raises(DatabaseError, match="is read and stays as it is"):
        reprocess(Request(inputs=[source], output=source, force=True))
    assert source.read_bytes() == before
    again(source, tmp_path, force=True)
    assert [path.name for path in tmp_path.iterdir()] == ["again.db"]


def test_an_edited_loop_is_taken_over_and_an_edited_step_is_named(tmp_path: Path) -> None:
    source = tmp_path / "edited.db"
    copyfile(saved(0), source)
    old = MapReader(source)
    first, last = min(old.poses()), max(old.poses())
    loop = replace(hand_link(old, last, first), type=LinkType.GLOBAL_CLOSURE)
    step = next(link for link in old.links() if link.pair == (first, first + 1))
    with MapWriter.open(source) as writer:
        for action, before, after in (("refine", None, loop), ("edit", step, step)):
            entry = JournalEntry(
                action=action, from_id=after.from_id, to_id=after.to_id, link_before=before, link_after=after
            )
            remove = [] if before is None else [(before.from_id, before.to_id)]
            writer.append_decision(entry, add=[after], remove=remove, poses={})
    new, summary = again(source, tmp_path)
    carried = {link.pair: link for link in new.links() if link.type is LinkType.USER_CLOSURE}
    np.testing.assert_allclose(carried[loop.pair].T_from_to, loop.T_from_to, atol=1e-6)
    assert summary["lost"] == [f"edit {first}-{first + 1} of edited.db: odometry is replayed as it was measured"]
