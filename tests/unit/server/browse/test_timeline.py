"""What a map was after each of its updates."""

from __future__ import annotations

import shutil
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from server.browse.events import updates
from server.browse.links import link_detail
from server.browse.loops import loops
from server.browse.map_view import MapView
from server.browse.moves import moves_of_states
from server.catalog import MapFile
from slam.database import JournalEntry, MapWriter
from slam.geometry import Pose, from_euler_rpy
from slam.types import LinkType, Placement, Tier
from tests.unit.server.loop_map import ACCEPTED, NODES, REFUSED, write_loop_map
from tests.unit.server.running import RunningApp


def view_of(path: Path) -> MapView:
    return MapView(MapFile("map", "map", path))


@pytest.fixture
def view(tmp_path: Path) -> MapView:
    write_loop_map(tmp_path / "map.db")
    return view_of(tmp_path / "map.db")


def test_the_last_moment_is_now(view: MapView) -> None:
    moment, snapshot = view.timeline().moment(NODES), view.snapshot()
    assert dict(moment.tiers) == dict(snapshot.tiers)
    assert moment.loops.keys() == {pair for pair, link in snapshot.links.items() if link.type.is_loop}
    assert moment.refused == ((REFUSED[1], REFUSED[0]),)


def test_a_moment_holds_what_had_happened_and_nothing_of_what_came_later(view: MapView) -> None:
    timeline = view.timeline()
    for at in range(1, NODES + 1):
        moment = timeline.moment(at)
        assert set(moment.tiers) == set(range(1, at + 1))
        in_ltm = {node_id for node_id, tier in moment.tiers.items() if tier is Tier.LTM}
        assert in_ltm == set(range(1, at - 5))
        assert moment.loops.keys() == {(older, newer) for newer, older in ACCEPTED if newer <= at}
        assert moment.T_map_base is not None


def test_the_past_of_a_map_that_was_turned_is_turned_with_it(view: MapView) -> None:
    T = from_euler_rpy(np.array([0.0, 0.0, 1.0]), np.array([2.0, 0.0, 0.0]))
    before = view.timeline().moment(NODES).T_map_base
    assert before is not None

    def decide(**values: Any) -> Pose | None:
        entry = JournalEntry(from_id=1, to_id=1, placement=Placement(T_new_old=T), **values)
        with MapWriter.open(view.file.path) as writer:
            writer.append_decision(entry, poses={})
        view.touch()
        return view.timeline().moment(NODES).T_map_base

    np.testing.assert_allclose(decide(action="turn"), T @ before)  # type: ignore[arg-type]
    np.testing.assert_allclose(decide(action="undo", undoes=1), before)  # type: ignore[arg-type]
    np.testing.assert_allclose(decide(action="turn", time=5.0), before)  # type: ignore[arg-type]


def test_a_decision_belongs_to_now_and_leaves_the_past_as_it_was(view: MapView) -> None:
    newer, older = ACCEPTED[0]
    link = view.snapshot().links[older, newer]
    entry = JournalEntry(action="reject", from_id=newer, to_id=older, link_before=link)
    with MapWriter.open(view.file.path) as writer:
        writer.append_decision(entry, remove=[(newer, older)], poses={})
    view.touch()
    timeline = view.timeline()
    assert (older, newer) not in timeline.snapshot.links
    assert timeline.moment(NODES).loops[older, newer] is LinkType.GLOBAL_CLOSURE


def test_updates_and_events_are_served_in_their_order(client: RunningApp) -> None:
    found = client.get("/api/maps/loops/timeline").json()
    assert found["ids"] == list(range(1, NODES + 1))
    assert found["memory"]
    events = found["events"]
    assert [one["at"] for one in events] == sorted(one["at"] for one in events)
    by_kind = {kind: [one for one in events if one["kind"] == kind] for kind in ("session", "loop", "refused")}
    assert [one["at"] for one in by_kind["session"]] == [1]
    assert [one["pairs"] for one in by_kind["loop"]] == [[list(pair)] for pair in ACCEPTED]
    assert [one["pairs"] for one in by_kind["refused"]] == [[list(REFUSED)]]
    transfers = [one for one in events if one["kind"] == "transfer"]
    assert [one["text"] for one in transfers] == [f"node {i} to long-term memory" for i in range(1, NODES - 5)]


def test_moves_are_what_lies_between_the_states_of_rtabmap(shared_data: Path, tmp_path: Path) -> None:
    source = shared_data / "rtabmap_db" / "cpp_0.23.8_tum_fr1_xyz_excerpt.db"
    view = view_of(Path(shutil.copy(source, tmp_path / "xyz.db")))
    timeline, states = view.timeline(), view.reader.wm_states()
    sizes = dict(
        zip(timeline.statistics.ids, timeline.statistics.values["Memory/Short_time_memory_size/"], strict=True)
    )
    for at, state in states.items():
        tiers = timeline.moment(at).tiers
        assert {i for i, tier in tiers.items() if tier is not Tier.LTM} == set(state.tolist())
        assert sum(tier is Tier.STM for tier in tiers.values()) == sizes[at]
    assert timeline.moment(45).best_id == 31
    measured = timeline.statistics.values
    rejected = int((measured["Loop/RejectedHypothesis/"] * measured["Loop/Highest_hypothesis_id/"] > 0).sum())
    assert [one.kind for one in updates(timeline).events].count("refused") == rejected


def test_states_are_read_in_pieces_to_the_same_moves(
    shared_data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = shared_data / "rtabmap_db" / "cpp_0.23.8_toyroom.db"
    view = view_of(Path(shutil.copy(source, tmp_path / "toy.db")))
    whole = [(move.id, dict(move.tiers)) for move in view.timeline().moves]
    monkeypatch.setattr("server.browse.moves._AT_ONCE", 7)
    pieces = moves_of_states(view.reader, view.statistics.table(), None, {})
    assert [(move.id, dict(move.tiers)) for move in pieces] == whole


def test_every_real_file_has_a_timeline(shared_data: Path, tmp_path: Path) -> None:
    for number, source in enumerate(sorted((shared_data / "rtabmap_db").glob("*.db"))):
        view = view_of(Path(shutil.copy(source, tmp_path / f"{number}.db")))
        found = updates(view.timeline())
        assert len(found.ids) == len(found.stamps) > 0
        assert all(a < b for a, b in pairwise(found.ids))
        assert {one.at for one in found.events} <= set(view.snapshot().all_nodes.ids.tolist())
        loops = {pair for pair, link in view.snapshot().links.items() if link.type.is_loop}
        assert view.timeline().moment(max(found.ids)).loops.keys() == loops


@pytest.mark.parametrize("name", ["toyroom", "tum_fr1_xyz_excerpt"])
def test_loops_of_rtabmap_have_the_evidence_that_its_statistics_tell(
    shared_data: Path, tmp_path: Path, name: str
) -> None:
    source = shared_data / "rtabmap_db" / f"cpp_0.23.8_{name}.db"
    view = view_of(Path(shutil.copy(source, tmp_path / "map.db")))
    measured = view.statistics.table()
    rows = {(row.to, row.from_): row for row in loops(view.snapshot()).loops}
    accepted = measured.values["Loop/Accepted_hypothesis_id/"]
    for k, newer in enumerate(measured.ids.tolist()):
        row = rows.get((int(accepted[k]), newer)) if accepted[k] > 0 else None
        if row is None:
            continue
        assert (row.inliers, row.matches) == tuple(
            int(measured.values[f"Loop/Visual_{what}/"][k]) for what in ("inliers", "matches")
        )
        if measured.values["Loop/Highest_hypothesis_id/"][k] == accepted[k]:
            assert row.posterior == measured.values["Loop/Highest_hypothesis_value/"][k]
            said = link_detail(view.snapshot(), newer, int(accepted[k])).explanation
            assert said.startswith(
                f"Accepted: hypothesis {row.posterior:.2f}, Rtabmap/LoopThr 0.11; {row.inliers} inliers"
            )
    known = [row for row in rows.values() if row.inliers is not None]
    assert len(known) >= 0.8 * len(rows) and any(row.posterior is not None for row in known)
    assert all(row.posterior is None for row in known if row.type == "LocalSpaceClosure")
