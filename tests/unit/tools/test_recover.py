"""Maps saved from damaged files."""

from __future__ import annotations

import random
import sqlite3
import tempfile
from contextlib import closing
from pathlib import Path
from shutil import copyfile

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slam.database import MapReader, MapWriter
from slam.database.pages import Lost, Pages, record, varint
from slam.database.salvage import salvage
from slam.errors import DatabaseError
from slam.tools.describe import describe
from slam.tools.recover import recover
from tests.tours import saved

PAGE = 4096


def tables(path: Path) -> dict[str, list[tuple[object, ...]]]:
    with closing(sqlite3.connect(path)) as connection:
        names = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite_%'")
        return {name: connection.execute(f"SELECT * FROM {name}").fetchall() for (name,) in names.fetchall()}


def root_of(path: Path, table: str) -> int:
    with closing(sqlite3.connect(path)) as connection:
        query = "SELECT rootpage FROM sqlite_master WHERE name = ?"
        return int(connection.execute(query, (table,)).fetchone()[0])


def damaged(path: Path, pages: list[int], fill: bytes = bytes(PAGE)) -> Path:
    content = bytearray(saved(0).read_bytes())
    for number in pages:
        content[(number - 1) * PAGE : number * PAGE] = fill
    path.write_bytes(content)
    return path


def test_of_a_sound_file_every_row_is_copied(tmp_path: Path) -> None:
    done = salvage(saved(0), tmp_path / "copy.db")
    assert not (done.gaps or done.cut or done.unreadable) and tables(tmp_path / "copy.db") == tables(saved(0))


def test_of_files_of_rtabmap_too(shared_data: Path, tmp_path: Path) -> None:
    for k, source in enumerate(sorted((shared_data / "rtabmap_db").glob("*.db"))):
        copy = tmp_path / f"{k}.db"
        salvage(source, copy)
        there, here = tables(source), tables(copy)
        assert {name: here[name] for name in there} == there, source.name


def test_a_lost_page_of_key_points_costs_those_alone(tmp_path: Path) -> None:
    leaves = [k for k in Pages(saved(0).read_bytes()).leaves(root_of(saved(0), "Feature"), set()) if isinstance(k, int)]
    number = leaves[7]
    summary = recover(damaged(tmp_path / "bad.db", [number]), tmp_path / "good.db")
    before, after = tables(saved(0)), tables(tmp_path / "good.db")
    assert summary["lost"]["pages"].keys() == {"Feature"} and not summary["is_whole"]
    assert 0 < len(before["Feature"]) - len(after["Feature"]) < 100
    assert {row[0]: row[1:] for row in after["Node"]} == {row[0]: row[1:] for row in before["Node"]}
    assert describe(MapReader(tmp_path / "good.db")).missing == ()


def test_pages_below_a_lost_one_are_found_by_what_is_in_them(tmp_path: Path) -> None:
    root = root_of(saved(0), "Feature")
    summary = recover(damaged(tmp_path / "bad.db", [root], b"\xff" * PAGE), tmp_path / "good.db")
    assert summary["found_beside_the_trees"]["Feature"] > 0
    assert sorted(tables(tmp_path / "good.db")["Feature"]) == sorted(tables(saved(0))["Feature"])


def test_lost_nodes_take_what_is_theirs_and_odometry_leads_on(tmp_path: Path) -> None:
    path = tmp_path / "bad.db"
    copyfile(saved(0), path)
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("DELETE FROM Node WHERE id IN (6, 7)")
        connection.execute("DELETE FROM Link WHERE from_id = 3 AND to_id = 4")
        connection.execute("DELETE FROM Word WHERE id < 20")
        connection.execute("DELETE FROM Info")
        connection.execute("DELETE FROM Admin")
        connection.commit()
    summary = recover(path, tmp_path / "good.db")
    mended = summary["mended"]
    assert mended["bridged"] == [[5, 8]] and mended["reversed"] == ((4, 3),)
    assert set(mended["dropped_links"]) >= {(5, 6), (6, 7), (7, 8)}
    assert mended["words"] > 0 and mended["lost_words"] == 0 and mended["dropped_rows"]["Data"] == 2
    assert mended["version"] == "0.20.0" and mended["parameters"]
    good = MapReader(tmp_path / "good.db")
    assert describe(good).missing == () and len(good.poses()) == 16 and summary["still_missing"] == []
    assert good.memory_ids()[0].tolist() == good.node_ids().tolist()


def test_a_page_of_a_long_value_costs_that_value_alone(tmp_path: Path) -> None:
    """Images are longer than a page: what comes after the image in its row is still there."""
    image = MapReader(saved(0)).image(9)
    number = saved(0).read_bytes().index(image[8000:8100]) // PAGE + 1
    summary = recover(damaged(tmp_path / "bad.db", [number]), tmp_path / "good.db")
    assert summary["lost"]["columns"] == {"Data": ["9: image"]} and not summary["lost"]["pages"]
    good = MapReader(tmp_path / "good.db")
    assert good.node(9).image_bytes == 0 and good.depth(9) == MapReader(saved(0)).depth(9)
    assert describe(good).missing == ()


def test_what_a_killed_writer_left_in_its_log_counts(tmp_path: Path) -> None:
    path = tmp_path / "killed.db"
    copyfile(saved(0), path)
    with MapWriter.open(path) as writer:
        writer.label_nodes({5: "door"})
        for end in ("", "-wal"):
            copyfile(path.with_name(path.name + end), tmp_path / f"copy.db{end}")
    recover(tmp_path / "copy.db", tmp_path / "good.db")
    assert MapReader(tmp_path / "good.db").nodes().labels[4] == "door"
    assert (tmp_path / "copy.db-wal").exists()


@settings(max_examples=12)
@given(st.integers(0, 10_000), st.booleans())
def test_whatever_is_damaged_the_answer_is_a_sound_map_or_one_line(seed: int, zeros: bool) -> None:
    rng = random.Random(seed)
    count = saved(0, 6).stat().st_size // PAGE
    with tempfile.TemporaryDirectory() as folder:
        content = bytearray(saved(0, 6).read_bytes())
        for _ in range(rng.randint(1, 12)):
            number = rng.randrange(count)
            content[number * PAGE : (number + 1) * PAGE] = bytes(PAGE) if zeros else rng.randbytes(PAGE)
        bad, good = Path(folder) / "bad.db", Path(folder) / "good.db"
        bad.write_bytes(content)
        try:
            recover(bad, good)
        except DatabaseError:
            assert not good.exists()
            return
        reader = MapReader(good)
        flaws = reader.flaws()
        assert not (flaws.one_way or flaws.dangling or flaws.unknown_words or flaws.orphan_features)
        assert bad.read_bytes() == content
        with closing(sqlite3.connect(good)) as connection:
            assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)


def test_a_file_that_is_no_map_is_refused(tmp_path: Path) -> None:
    (tmp_path / "x.db").write_bytes(random.Random(1).randbytes(40_000))
    with pytest.raises(DatabaseError, match="no node could be read"):
        recover(tmp_path / "x.db", tmp_path / "good.db")
    assert not (tmp_path / "good.db").exists()


@given(st.integers(0, 2**64 - 1))
def test_numbers_of_varying_length(value: int) -> None:
    if value < 1 << 56:
        parts = [value & 0x7F]
        while value >> 7 * len(parts):
            parts.append(value >> 7 * len(parts) & 0x7F | 0x80)
        encoded = bytes(reversed(parts))
    else:
        encoded = bytes([value >> 8 + 7 * k & 0x7F | 0x80 for k in range(7, -1, -1)] + [value & 0xFF])
    assert varint(encoded + b"x", 0) == (value, len(encoded))


def test_values_beyond_the_end_of_a_row_are_lost() -> None:
    assert record(bytes([4, 1, 18, 1, 7, 65, 66])) == (7, Lost.LOST, Lost.LOST)
