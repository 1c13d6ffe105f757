"""What RTAB-Map loads into working memory: nodes and words not older than the newest Info row."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from slam.database import MapReader, MapWriter
from slam.params import Params
from tests.unit.database.map_records import record, write_map

RULE = "SELECT id FROM {} WHERE time_enter >= (SELECT MAX(time_enter) FROM Info) ORDER BY id"


def loaded(path: Path) -> tuple[list[int], list[int]]:
    """Ids of the nodes and words that RTAB-Map's own query selects; the reader says the same."""
    with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as connection:
        nodes, words = ([i for (i,) in connection.execute(RULE.format(table))] for table in ("Node", "Word"))
    said = MapReader(path).memory_ids()
    assert (nodes, words) == (said[0].tolist(), said[1].tolist())
    return nodes, words


def words_of(*node_ids: int) -> list[int]:
    return [1000 * i + j for i in node_ids for j in range(1, 11)]


def test_after_closing_what_was_in_ram_and_nothing_else_is_loaded(tmp_path: Path) -> None:
    """All in one second: the stamps, not the clock, make the rule hold."""
    path = write_map(tmp_path / "map.db", 6)
    assert loaded(path) == ([4, 5, 6], words_of(4, 5, 6))


def test_while_a_session_runs_all_its_nodes_are_loaded(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        for i in (1, 2, 3):
            writer.add_node(record(i))
            assert loaded(path) == (list(range(1, i + 1)), words_of(*range(1, i + 1)))


def test_a_second_session_goes_on_from_the_first_one_s_memory(tmp_path: Path) -> None:
    path = write_map(tmp_path / "map.db", 6)
    with MapWriter.open(path) as writer:
        assert loaded(path) == ([4, 5, 6], words_of(4, 5, 6))
        map_id = writer.start_session(Params(), seed=1, source="more")
        assert loaded(path) == ([4, 5, 6], words_of(4, 5, 6))
        writer.add_node(record(7, map_id=map_id))
        assert loaded(path) == ([4, 5, 6, 7], words_of(4, 5, 6, 7))
        writer.close_session(ram_ids=[2, 7], ram_word_ids=words_of(7), params=Params())
    assert loaded(path) == ([2, 7], words_of(7))
    assert MapReader(path).nodes().labels == ("map0", None, None, None, None, None, "map1")


def test_odometry_that_begins_anew_keeps_the_memory(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        writer.add_node(record(1))
        assert writer.start_session(Params(), seed=0, source="") == 1
        writer.add_node(record(2, map_id=1, links=()))
        writer.close_session(ram_ids=[1, 2], ram_word_ids=[], params=Params())
    assert loaded(path)[0] == [1, 2]
    with closing(sqlite3.connect(path)) as connection:
        assert connection.execute("SELECT COUNT(*) FROM Info").fetchone() == (2,)  # the beginning and the end
    assert [session.clean for session in MapReader(path).sessions()] == [True, True]


@pytest.mark.parametrize("clock", ["2001-01-01 00:00:00", "2099-01-01 00:00:00"])
def test_a_clock_that_is_wrong_does_no_harm(tmp_path: Path, clock: str) -> None:
    path = write_map(tmp_path / "map.db", 3)
    with closing(sqlite3.connect(path)) as connection:
        for table in ("Node", "Word", "Info"):
            connection.execute(f"UPDATE {table} SET time_enter = ?", (clock,))
        connection.commit()
    with MapWriter.open(path) as writer:
        map_id = writer.start_session(Params(), seed=0, source="")
        writer.add_node(record(4, map_id=map_id))
        assert loaded(path)[0] == [1, 2, 3, 4]
        writer.close_session(ram_ids=[1, 4], ram_word_ids=words_of(1), params=Params())
    assert loaded(path) == ([1, 4], words_of(1))


def test_the_info_rows(tmp_path: Path) -> None:
    path = write_map(tmp_path / "map.db", 4, Params().changed({"Kp/MaxFeatures": 300}))
    columns = "STM_size, last_sign_added, dictionary_size, parameters"
    with closing(sqlite3.connect(path)) as connection:
        first, last = connection.execute(f"SELECT {columns} FROM Info ORDER BY time_enter").fetchall()
    assert first[:3] == (0, 0, 0)
    assert last[:3] == (3, 4, 30)
    for row in (first, last):
        assert "Kp/MaxFeatures:300;" in row[3]
