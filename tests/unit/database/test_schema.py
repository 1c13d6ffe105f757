"""The schema of a new file is RTAB-Map 0.20.0's: its tools assert that each column exists."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from slam.database import MapWriter
from slam.params import Params

# Columns in order: name:type, with ! for NOT NULL and * for the primary key.
COLUMNS = {
    "Node": "id:INTEGER!* map_id:INTEGER! weight:INTEGER stamp:FLOAT pose:BLOB ground_truth_pose:BLOB velocity:BLOB"
    " label:TEXT gps:BLOB env_sensors:BLOB time_enter:DATE",
    "Data": "id:INTEGER!* image:BLOB depth:BLOB calibration:BLOB scan:BLOB scan_info:BLOB ground_cells:BLOB"
    " obstacle_cells:BLOB empty_cells:BLOB cell_size:FLOAT view_point_x:FLOAT view_point_y:FLOAT view_point_z:FLOAT"
    " user_data:BLOB time_enter:DATE",
    "Link": "from_id:INTEGER! to_id:INTEGER! type:INTEGER! information_matrix:BLOB! transform:BLOB user_data:BLOB",
    "Word": "id:INTEGER!* descriptor_size:INTEGER! descriptor:BLOB! time_enter:DATE",
    "Feature": "node_id:INTEGER! word_id:INTEGER! pos_x:FLOAT! pos_y:FLOAT! size:INTEGER! dir:FLOAT! response:FLOAT!"
    " octave:INTEGER! depth_x:FLOAT depth_y:FLOAT depth_z:FLOAT descriptor_size:INTEGER descriptor:BLOB",
    "GlobalDescriptor": "node_id:INTEGER! type:INTEGER! info:BLOB data:BLOB!",
    "Info": "STM_size:INTEGER last_sign_added:INTEGER process_mem_used:INTEGER database_mem_used:INTEGER"
    " dictionary_size:INTEGER parameters:TEXT time_enter:DATE",
    "Statistics": "id:INTEGER! stamp:FLOAT data:BLOB wm_state:BLOB",
    "Admin": "version:TEXT preview_image:BLOB opt_cloud:BLOB opt_ids:BLOB opt_poses:BLOB opt_last_localization:BLOB"
    " opt_polygons_size:INTEGER opt_polygons:BLOB opt_tex_coords:BLOB opt_tex_materials:BLOB opt_map:BLOB"
    " opt_map_x_min:FLOAT opt_map_y_min:FLOAT opt_map_resolution:FLOAT time_enter:DATE",
}
INDEXES = {
    ("Node", "id", 1),
    ("Node", "label", 1),
    ("Statistics", "id", 1),
    ("Feature", "node_id", 0),
    ("GlobalDescriptor", "node_id", 0),
    ("Link", "from_id", 0),
}
TRIGGERS = {"insert_Feature", *(f"insert_{table}_timeEnter" for table in ("Node", "Data", "Word", "Info"))}


@pytest.fixture
def new_file(tmp_path: Path) -> Path:
    """A map without nodes."""
    path = tmp_path / "map.db"
    MapWriter.create(path, Params(), seed=0, source="").close()
    return path


def columns(connection: sqlite3.Connection, table: str) -> str:
    """A table's columns in the notation above."""
    rows = connection.execute(f"PRAGMA table_info({table})").fetchall()
    return " ".join(f"{name}:{kind}{'!' * missing}{'*' * key}" for _, name, kind, missing, _, key in rows)


def indexes(connection: sqlite3.Connection) -> set[tuple[str, str, int]]:
    """Table, column and uniqueness of every index on one column of RTAB-Map's tables."""
    found = set()
    for table in COLUMNS:
        for _, name, unique, *_ in connection.execute(f"PRAGMA index_list({table})").fetchall():
            ((_, _, column),) = connection.execute(f"PRAGMA index_info({name})").fetchall()
            found.add((table, column, unique))
    return found


def test_tables_indexes_and_triggers(new_file: Path) -> None:
    with closing(sqlite3.connect(new_file)) as connection:
        assert {table: columns(connection, table) for table in COLUMNS} == COLUMNS
        assert indexes(connection) == INDEXES
        triggers = connection.execute("SELECT name FROM sqlite_master WHERE type = 'trigger'").fetchall()
        assert {name for (name,) in triggers} == TRIGGERS
        assert connection.execute("SELECT version FROM Admin").fetchall() == [("0.20.0",)]
        names = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'").fetchall()
        assert {name for (name,) in names if not name.startswith("deck_")} == set(COLUMNS)


def test_the_triggers_do_what_rtabmap_s_do(new_file: Path) -> None:
    with closing(sqlite3.connect(new_file)) as connection:
        with pytest.raises(sqlite3.IntegrityError, match="Foreign key constraint failed in Feature table"):
            connection.execute(
                "INSERT INTO Feature(node_id, word_id, pos_x, pos_y, size, dir, response, octave)"
                " VALUES (1, 1, 0, 0, 1, 0, 0, 0)"
            )
        connection.execute("INSERT INTO Node(id, map_id) VALUES (1, 0)")
        connection.execute("INSERT INTO Word(id, descriptor_size, descriptor) VALUES (1, 1, x'00')")
        now = connection.execute("SELECT DATETIME('NOW')").fetchone()
        for table in ("Node", "Word"):
            assert connection.execute(f"SELECT time_enter FROM {table}").fetchone() <= now
        connection.execute("UPDATE Node SET time_enter = NULL")
        connection.execute("INSERT INTO Data(id) VALUES (1)")
        assert connection.execute("SELECT time_enter FROM Node").fetchone()[0] is not None


def test_it_is_the_schema_of_a_real_file(new_file: Path, shared_data: Path) -> None:
    (real,) = (shared_data / "rtabmap_db" / "empty_schema").glob("carlesmartin85*.db")  # 0.20.18
    with (
        closing(sqlite3.connect(new_file)) as ours,
        closing(sqlite3.connect(f"file:{real}?immutable=1", uri=True)) as theirs,
    ):
        tables = theirs.execute("SELECT name FROM sqlite_master WHERE type = 'table'").fetchall()
        assert {name for (name,) in tables} == set(COLUMNS)
        for table in COLUMNS:
            assert columns(ours, table) == columns(theirs, table)
            keys = 'SELECT "from", "table", "to" FROM pragma_foreign_key_list(?) ORDER BY 1'
            assert ours.execute(keys, (table,)).fetchall() == theirs.execute(keys, (table,)).fetchall()
        assert indexes(ours) == indexes(theirs)


def test_the_file_is_plain(new_file: Path) -> None:
    assert [path.name for path in new_file.parent.iterdir()] == ["map.db"]
    with closing(sqlite3.connect(new_file)) as connection:
        assert connection.execute("PRAGMA journal_mode").fetchone() == ("delete",)
        assert connection.execute("PRAGMA application_id").fetchone() == (0,)
        assert connection.execute("PRAGMA user_version").fetchone() == (0,)
