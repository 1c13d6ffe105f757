"""Whatever is given as a map, the answer is one line that says what, where and what would be right."""

from __future__ import annotations

import random
import shutil
import sqlite3
from collections.abc import Callable
from contextlib import closing
from functools import partial
from pathlib import Path

import pytest

from slam.database import MapReader, MapWriter
from slam.database.refusal import refusing
from slam.errors import DatabaseError, MapBusyError
from slam.params import Params
from tests.unit.database.map_records import record, write_map
from tests.unit.database.test_reader import CALLS


def changed(path: Path, *statements: str) -> Path:
    """A map after these statements."""
    write_map(path)
    with closing(sqlite3.connect(path)) as connection:
        for statement in statements:
            connection.execute(statement)
        connection.commit()
    return path


def missing(path: Path) -> Path:
    return path


def folder(path: Path) -> Path:
    path.mkdir()
    return path


def empty(path: Path) -> Path:
    path.touch()
    return path


def text(path: Path) -> Path:
    path.write_text("timestamp tx ty tz\n" * 50)
    return path


def other_sqlite(path: Path) -> Path:
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("CREATE TABLE t(a)")
    return path


def two_admins(path: Path) -> Path:
    return changed(path, "INSERT INTO Admin(version) VALUES ('0.20.0')")


def no_admin_row(path: Path) -> Path:
    return changed(path, "DELETE FROM Admin")


def too_new(path: Path) -> Path:
    return changed(path, "UPDATE Admin SET version = '0.24.0'")


def too_old(path: Path) -> Path:
    return changed(path, "UPDATE Admin SET version = '0.4.9'")


def no_version(path: Path) -> Path:
    return changed(path, "UPDATE Admin SET version = NULL")


def cut_off(path: Path) -> Path:
    whole = write_map(path).read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    return path


BAD: tuple[tuple[Callable[[Path], Path], str], ...] = (
    (missing, "does not exist"),
    (folder, "is a folder"),
    (empty, "is empty"),
    (text, "file is not a database; a map file of RTAB-Map or slamdeck is needed"),
    (other_sqlite, "no such table: Admin"),
    (two_admins, "Admin has 2 rows, and exactly one is right"),
    (no_admin_row, "Admin has 0 rows, and exactly one is right"),
    (too_new, "RTAB-Map 0.24.0, which is too new: versions 0.5 to 0.23 can be read"),
    (too_old, "RTAB-Map 0.4.9, which is too old: versions 0.5 to 0.23 can be read"),
    (no_version, "no version of RTAB-Map"),
    (cut_off, "the file is damaged or cut off: copy it again"),
)


@pytest.mark.parametrize(("make", "says"), BAD)
@pytest.mark.parametrize("use", [MapReader, MapWriter.open])
def test_what_is_no_map_is_refused(
    tmp_path: Path, make: Callable[[Path], Path], says: str, use: Callable[[Path], object]
) -> None:
    path = make(tmp_path / "bad.db")
    before = path.read_bytes() if path.is_file() else b""
    with pytest.raises(DatabaseError, match=says) as caught:
        use(path)
    message = str(caught.value)
    assert str(path) in message
    assert "\n" not in message
    assert [item.name for item in tmp_path.iterdir()] == ([path.name] if path.exists() else [])
    assert not path.is_file() or path.read_bytes() == before


def test_versions_up_to_the_last_patch_are_read(tmp_path: Path) -> None:
    for version in ("0.18.0", "0.23.99"):
        path = changed(tmp_path / f"{version}.db", f"UPDATE Admin SET version = '{version}'")
        assert MapReader(path).info().version == version


def test_an_existing_file_is_not_overwritten(tmp_path: Path) -> None:
    path = write_map(tmp_path / "map.db")
    before = path.read_bytes()
    with pytest.raises(DatabaseError, match=r"map\.db exists already: choose another name, or open it"):
        MapWriter.create(path, Params(), seed=0, source="")
    assert path.read_bytes() == before
    assert [item.name for item in tmp_path.iterdir()] == ["map.db"]


def test_a_folder_that_is_missing_is_named(tmp_path: Path) -> None:
    with pytest.raises(DatabaseError, match="nowhere"):
        MapWriter.create(tmp_path / "nowhere" / "map.db", Params(), seed=0, source="")


def _read(call: Callable[[MapReader], object], path: Path) -> None:
    call(MapReader(path))


def _write(path: Path) -> None:
    MapWriter.open(path).close()


def test_a_damaged_file_gives_answers_or_one_error(tmp_path: Path) -> None:
    """Random bytes of a map are changed; nothing may be raised but a DatabaseError that names the file."""
    whole = write_map(tmp_path / "whole.db").read_bytes()
    path = tmp_path / "damaged.db"
    refused = 0
    for seed in range(40):
        chance = random.Random(seed)
        damaged = bytearray(whole)
        for _ in range(chance.choice([1, 20, 400])):
            damaged[chance.randrange(100, len(damaged))] = chance.randrange(256)
        path.write_bytes(damaged)
        uses: list[Callable[[Path], None]] = [*(partial(_read, call) for call in CALLS), _write]
        for use in uses:
            try:
                use(path)
            except DatabaseError as error:
                refused += 1
                assert str(path) in str(error)
    assert refused > 70


@pytest.mark.parametrize(
    ("statement", "call"),
    [
        ("UPDATE Node SET weight = 'heavy'", lambda reader: reader.nodes()),
        ("UPDATE Node SET stamp = 'noon'", lambda reader: reader.nodes()),
        ("UPDATE Node SET map_id = 99999999999", lambda reader: reader.nodes()),
        ("UPDATE Link SET information_matrix = x'00'", lambda reader: reader.links()),
        ("UPDATE Link SET type = 99", lambda reader: reader.links()),
        ("UPDATE Feature SET descriptor = NULL WHERE word_id = 1001", lambda reader: reader.features(1)),
        ("UPDATE Feature SET pos_x = 'left'", lambda reader: reader.features(1)),
        ("UPDATE Data SET calibration = x'0000000000'", lambda reader: reader.camera(1)),
        ("UPDATE Data SET image = x'ffd8ffe000'", lambda reader: reader.image_bgr(1)),
        ("UPDATE Data SET depth = image", lambda reader: reader.depth_m(1)),
        ("UPDATE Admin SET opt_poses = opt_ids", lambda reader: reader.poses()),
        ("UPDATE Admin SET opt_poses = x'78'||'0123456789ab'", lambda reader: reader.poses()),
        ("UPDATE deck_update SET tiers = 'stm'", lambda reader: reader.updates()),
        ('UPDATE deck_update SET tiers = \'{"1": "attic"}\'', lambda reader: reader.updates()),
        ("DELETE FROM deck_hypothesis WHERE place_id = -1", lambda reader: reader.hypotheses(2)),
        ("DELETE FROM deck_hypothesis WHERE place_id = -1", lambda reader: reader.beliefs()),
        ("UPDATE deck_candidate SET type = 42", lambda reader: reader.candidates()),
        ("DROP TABLE deck_candidate", lambda reader: reader.candidates()),
    ],
)
def test_nonsense_in_a_column_is_one_error(tmp_path: Path, statement: str, call: Callable[[MapReader], object]) -> None:
    path = changed(tmp_path / "map.db", statement)
    with pytest.raises(DatabaseError, match=r"map\.db") as caught:
        call(MapReader(path))
    assert "\n" not in str(caught.value)


def test_a_full_disk_is_said_and_leaves_all_that_was_there(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        writer.add_node(record(1))
        driver = writer._connection.connection.driver_connection
        assert isinstance(driver, sqlite3.Connection)
        (pages,) = driver.execute("PRAGMA page_count").fetchone()
        driver.execute(f"PRAGMA max_page_count = {pages}")
        with pytest.raises(
            DatabaseError, match=r"map\.db: adding node 2 failed: database or disk is full; .* free some"
        ):
            writer.add_node(record(2, count=2000))
        assert MapReader(path).node_ids().tolist() == [1]
        driver.execute("PRAGMA max_page_count = 100000")
        writer.add_node(record(2))
    assert MapReader(path).node_ids().tolist() == [1, 2]
    with closing(sqlite3.connect(path)) as connection:
        assert connection.execute("PRAGMA integrity_check").fetchall() == [("ok",)]


def test_a_lock_of_another_program_is_said_and_leaves_all_that_was_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """RTAB-Map does not know slamdeck's lock, but SQLite's."""
    monkeypatch.setattr("slam.database.connection.BUSY_SECONDS", 0.1)
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        writer.add_node(record(1))
        with closing(sqlite3.connect(path, isolation_level=None)) as other:
            other.execute("BEGIN IMMEDIATE")
            with pytest.raises(MapBusyError, match="another program holds the file"):
                writer.add_node(record(2))
            other.execute("ROLLBACK")
        writer.add_node(record(2))
    assert MapReader(path).node_ids().tolist() == [1, 2]


def test_a_reader_waits_as_long_as_it_is_told_for_a_file_that_another_program_holds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The usual wait would be seen.
    monkeypatch.setattr("slam.database.connection.BUSY_SECONDS", 600.0)
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        writer.add_node(record(1))
    with closing(sqlite3.connect(path, isolation_level=None)) as other:
        other.execute("BEGIN EXCLUSIVE")
        with pytest.raises(MapBusyError, match="another program holds the file"):
            MapReader(path, 0.01)
    assert MapReader(path, 0.01).node_ids().tolist() == [1]


def test_a_reader_that_stays_keeps_the_log_but_loses_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("slam.database.connection.BUSY_SECONDS", 0.1)
    path = tmp_path / "map.db"
    writer = MapWriter.create(path, Params(), seed=0, source="")
    writer.add_node(record(1))
    with closing(sqlite3.connect(path, isolation_level=None)) as other:
        other.execute("BEGIN")
        other.execute("SELECT * FROM Node").fetchall()
        with pytest.raises(MapBusyError, match="closing failed"):
            writer.close()
        writer.close()
        assert MapReader(path).node_ids().tolist() == [1]
    MapWriter.open(path).close()
    assert [item.name for item in tmp_path.iterdir()] == ["map.db"]


def test_errors_of_the_system_are_turned_too(tmp_path: Path) -> None:
    with pytest.raises(DatabaseError, match="doing failed: No space left"), refusing(tmp_path, "doing"):
        raise OSError(28, "No space left on device")


def test_a_copy_of_a_map_is_a_map(tmp_path: Path) -> None:
    copy = Path(shutil.copy(write_map(tmp_path / "map.db"), tmp_path / "a copy, with spaces % and #?.db"))
    assert len(MapReader(copy).nodes()) == 5
    MapWriter.open(copy).close()


def test_a_map_that_can_t_be_made_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise sqlite3.OperationalError("database or disk is full")

    monkeypatch.setattr("slam.database.new_file.create_schema", full)
    with pytest.raises(DatabaseError, match=r"creating the map failed: database or disk is full; .*free some space"):
        MapWriter.create(tmp_path / "map.db", Params(), seed=0, source="")
    assert list(tmp_path.iterdir()) == []
