"""What a file's schema says is not carried out, and what is read has bounds."""

from __future__ import annotations

import sqlite3
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

from slam.database import MapReader, MapWriter
from slam.errors import DatabaseError
from tests.unit.database.map_records import write_map
from tests.unit.database.test_reader import CALLS

_ENDLESS = "WITH RECURSIVE k(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM k) SELECT i FROM k"
_VIEW = "CREATE VIEW {0} AS SELECT i AS id, 0 AS map_id FROM (" + _ENDLESS + ")"


def planted(path: Path, *statements: str, schema: tuple[tuple[str, str], ...] = ()) -> Path:
    """A map after these statements, and with text of its schema replaced."""
    write_map(path, 3)
    with closing(sqlite3.connect(path)) as connection:
        for statement in statements:
            connection.execute(statement)
        connection.commit()
        if schema:
            connection.execute("PRAGMA writable_schema = ON")
            for old, new in schema:
                connection.execute("UPDATE sqlite_master SET sql = replace(sql, ?, ?)", (old, new))
            connection.commit()
    return path


@pytest.mark.parametrize(
    ("statements", "says"),
    [
        (("DROP TABLE Statistics", _VIEW.format("Statistics")), "its Statistics is a view, and a table is needed"),
        (("DROP TABLE deck_frame", _VIEW.format("DECK_Frame")), "its DECK_Frame is a view, and a table is needed"),
        (("CREATE VIRTUAL TABLE words USING fts4(a)",), "'words' that is virtual: a map has plain tables only"),
        (
            ("DROP TABLE Info", "CREATE TABLE Info(STM_size, x TEXT GENERATED ALWAYS AS (hex(zeroblob(1000000000))))"),
            "column x of its table Info is computed, not stored",
        ),
    ],
)
@pytest.mark.parametrize("use", [MapReader, MapWriter.open])
def test_only_plain_tables_are_taken_for_those_of_a_map(
    tmp_path: Path, statements: tuple[str, ...], says: str, use: Callable[[Path], object]
) -> None:
    path = planted(tmp_path / "map.db", *statements)
    before = path.read_bytes()
    with pytest.raises(DatabaseError, match=says):
        use(path)
    assert path.read_bytes() == before


def test_a_view_under_another_entry_s_name_is_found(tmp_path: Path) -> None:
    path = planted(
        tmp_path / "map.db",
        "DROP TABLE Statistics",
        "CREATE VIEW harmless AS SELECT 1",
        schema=(("VIEW harmless", "VIEW Statistics"),),
    )
    with pytest.raises(DatabaseError, match=r"malformed database schema|whose text says something else"):
        MapReader(path)


def test_views_that_unfold_for_ever_are_not_unfolded(tmp_path: Path) -> None:
    """Each stands for two of the one before: 2 to the 60th selections in a few hundred bytes."""
    views = [f"CREATE VIEW v{i + 1} AS SELECT a.i FROM v{i} a, v{i} b" for i in range(60)]
    path = planted(tmp_path / "map.db", "CREATE VIEW v0 AS SELECT 1 AS i", *views)
    start = time.monotonic()
    reader = MapReader(path)
    for call in CALLS:
        call(reader)
    assert time.monotonic() - start < 60


@pytest.mark.parametrize(
    ("statement", "says"),
    [
        (
            "CREATE TRIGGER grab AFTER UPDATE ON Admin BEGIN DELETE FROM Node; END",
            "trigger 'grab', which is none of RTAB",
        ),
        ("CREATE TRIGGER insert_Node_timeEnter2 AFTER INSERT ON deck_journal BEGIN DELETE FROM Link; END", "a trigger"),
        ("CREATE INDEX slow ON Node(hex(label))", "index 'slow', which is not one of plain columns"),
        ("CREATE INDEX part ON Node(id) WHERE weight > 0", "index 'part', which is not one of plain columns"),
        ("CREATE TABLE mine(a CHECK (a > 0))", "table 'mine' with the rule 'CHECK'"),
        ("CREATE TABLE mine(a UNIQUE ON CONFLICT REPLACE)", "table 'mine' with the rule 'ON CONFLICT'"),
    ],
)
def test_a_file_that_would_do_things_of_its_own_is_read_but_not_written(
    tmp_path: Path, statement: str, says: str
) -> None:
    path = planted(tmp_path / "map.db", statement)
    before = path.read_bytes()
    reader = MapReader(path)
    for call in CALLS:
        call(reader)
    with pytest.raises(DatabaseError, match=says):
        MapWriter.open(path)
    assert path.read_bytes() == before


def test_the_triggers_and_indexes_of_rtabmap_are_known(shared_data: Path, tmp_path: Path) -> None:
    for path in sorted((shared_data / "rtabmap_db").glob("*.db")):
        copy = tmp_path / path.name
        copy.write_bytes(path.read_bytes())
        try:
            MapWriter.open(copy).close()
        except DatabaseError as error:
            assert "written by RTAB-Map" in str(error), error


def test_a_call_takes_no_more_steps_than_its_file_has_room_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = planted(tmp_path / "map.db")
    monkeypatch.setattr("slam.database.guard._STEPS", 0)
    monkeypatch.setattr("slam.database.guard._STEPS_PER_BYTE", 0)
    monkeypatch.setattr("slam.database.guard._LOOK_EVERY", 10)
    with pytest.raises(DatabaseError, match="asks for more work than one of its size can hold"):
        MapReader(path)


def test_values_larger_than_any_of_a_map_are_refused(tmp_path: Path) -> None:
    path = planted(tmp_path / "map.db", "UPDATE Node SET label = hex(zeroblob(600000)) WHERE id = 2")
    with pytest.raises(DatabaseError, match="larger than any of a map"):
        MapReader(path).nodes()
    assert MapReader(path).camera(2).width == 64
