"""A map that is gone on with: what a new session starts from, and how a loop makes one map of both."""

from __future__ import annotations

import shutil
import sqlite3
from contextlib import closing
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from slam.database import MapReader, MapWriter
from slam.errors import ParameterError
from slam.geometry import between, translation_norm
from slam.memory.past import Past, recall
from slam.params import Params
from slam.run import ate_rmse_m
from slam.slam import Slam
from slam.types import Frame, Tier, Update
from tests.tours import EVERY, fed, saved, there_and_back, truth

TURN = 18


def way() -> list[Frame]:
    return there_and_back(TURN)


def appended(path: Path, params: Params = EVERY) -> tuple[Slam, Past]:
    writer = MapWriter.open(path)
    past = recall(MapReader(path), params, seed=0)
    writer.start_session(params, seed=0, source="back")
    return Slam(params, writer, source="back", past=past), past


@cache
def both_sessions() -> tuple[Slam, tuple[Update, ...], Path]:
    """The way there and, as a second session, back again."""
    path = Path(shutil.copy(saved(0), saved(0).with_name("both.db")))
    slam, _ = appended(path)
    updates = fed(slam, way()[TURN:])
    slam.close()
    return slam, tuple(updates), path


def test_ids_go_on_in_a_new_session() -> None:
    slam, updates, path = both_sessions()
    nodes = [update.node for update in updates if update.node is not None]
    assert [node.id for node in nodes] == list(range(TURN + 1, TURN + 1 + len(nodes)))
    assert {node.map_id for node in nodes} == {1}
    table = MapReader(path).nodes()
    assert table.map_ids.tolist() == [0] * TURN + [1] * len(nodes)
    assert [(s.map_id, s.source, s.clean) for s in MapReader(path).sessions()] == [
        (0, "there", True),
        (1, "back", True),
    ]
    assert (TURN, TURN + 1) not in slam.graph.links, "no odometry leads from one session to the other"


def test_a_loop_makes_one_map_of_two_sessions() -> None:
    slam, updates, path = both_sessions()
    first = next(k for k, update in enumerate(updates) if update.optimized)
    assert slam.graph.component(1) == slam.graph.poses.keys()
    T_world = truth(way())
    true, found = between(T_world[0], T_world[-1]), between(slam.graph.poses[1], slam.graph.poses[slam.graph.newest])
    assert translation_norm(between(true, found)) < 0.1, "both are the same place"
    error = ate_rmse_m(slam)
    assert error is not None
    assert error < 0.03
    assert len(slam.frames) == len(way()) == len(MapReader(path).trajectory())
    assert first < 12, "the way back shows what the way there has shown"


def test_sessions_that_nothing_joins_are_judged_each_on_its_own(tmp_path: Path) -> None:
    path = Path(shutil.copy(saved(0), tmp_path))
    slam, _ = appended(path, EVERY.changed({"Rtabmap/LoopThr": 1.0, "RGBD/AggressiveLoopThr": 1.0}))
    fed(slam, way()[TURN : TURN + 8])
    slam.close()
    assert slam.graph.component(1) == set(range(1, TURN + 1))
    error = ate_rmse_m(slam)
    assert error is not None
    assert error < 0.03, "both start at the origin; taken for one path they would be metres off"


@pytest.mark.parametrize("everything", [False, True])
def test_working_memory_starts_as_it_was_left_or_with_everything(everything: bool) -> None:
    path = saved(4)
    left, words = MapReader(path).memory_ids()
    past = recall(MapReader(path), EVERY.changed({"Mem/InitWMWithAllNodes": everything}), seed=0)
    memory = past.memory
    assert sorted(memory.wm) == (list(range(1, TURN + 1)) if everything else left.tolist())
    assert not memory.stm
    assert memory.ltm == set(range(1, TURN + 1)) - memory.wm.keys()
    assert (len(memory.ltm) > 0) != everything
    if not everything:
        assert memory.dictionary.ids() == words.tolist()
    assert set(memory.dictionary.ids()) == {int(w) for bag in memory.bags.values() for w in bag.words}
    assert memory.take_moves() == {i: Tier.WM if i in memory.wm else Tier.LTM for i in range(1, TURN + 1)}


def test_nodes_and_words_are_what_the_last_session_had() -> None:
    path, reader = saved(0), MapReader(saved(0))
    memory = recall(reader, EVERY, seed=0).memory
    for node_id in (1, TURN):
        features, word_ids = reader.features(node_id)
        np.testing.assert_array_equal(memory.nodes[node_id].word_ids, word_ids)
        np.testing.assert_array_equal(memory.nodes[node_id].features.descriptors, features.descriptors)
    stored = reader.words(memory.dictionary.ids())
    np.testing.assert_array_equal(memory.dictionary.descriptors(stored.ids), stored.descriptors)
    made = memory.quantize(memory.nodes[TURN].features, EVERY)[1]
    assert made.ids.min(initial=1 << 30) > MapReader(path).last_word_id(), "new words have ids that none has had"


def test_nodes_of_an_earlier_session_come_back_from_long_term_memory(tmp_path: Path) -> None:
    path = Path(shutil.copy(saved(4), tmp_path))
    slam, past = appended(path, EVERY.changed({"Rtabmap/MemoryThr": 12}))
    away = set(past.memory.ltm)
    updates = fed(slam, way()[TURN:])
    slam.close()
    back = {i for update in updates[1:] for i, tier in update.tiers.items() if tier is Tier.WM} & away
    assert back
    assert slam.graph.component(1) == slam.graph.poses.keys()


def test_the_grid_of_the_earlier_session_comes_with_the_loop() -> None:
    _, _, path = both_sessions()
    reader = MapReader(path)
    whole, alone = reader.grid(), MapReader(saved(0)).grid()
    assert whole is not None
    assert alone is not None
    assert (whole.cells >= 0).sum() > 0.9 * (alone.cells >= 0).sum()


def test_words_of_another_kind_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    path = Path(shutil.copy(saved(0), tmp_path))
    with closing(sqlite3.connect(path)) as database:
        database.execute("UPDATE Word SET descriptor = zeroblob(64), descriptor_size = 64")
        database.commit()
    before = path.read_bytes()
    with pytest.raises(ParameterError, match="64 uint8"):
        recall(MapReader(path), EVERY, seed=0)
    assert path.read_bytes() == before
