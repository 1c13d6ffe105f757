"""Links lie in both directions with the same information, and the file keeps RTAB-Map's rules."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sqlalchemy import create_engine

from slam.database import Faults, MapReader, MapWriter
from slam.database.blobs import pack_transform, unpack_information, unpack_transform
from slam.database.link_rows import read_links
from slam.database.tables import link as link_table
from slam.errors import DatabaseError
from slam.geometry import inverse
from slam.params import Params
from slam.types import WEIGHT_INVALID, Link, LinkType
from tests.unit.database.map_records import pose, record, write_map


@pytest.fixture
def writer(tmp_path: Path) -> Iterator[MapWriter]:
    """A writer of a map of three nodes."""
    with MapWriter.create(tmp_path / "map.db", Params(), seed=0, source="") as writer:
        for i in (1, 2, 3):
            writer.add_node(record(i))
        yield writer


def rows(path: Path) -> list[tuple[Any, ...]]:
    with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as connection:
        query = "SELECT from_id, to_id, type, information_matrix, transform FROM Link ORDER BY from_id, to_id, type"
        return connection.execute(query).fetchall()


def loop(from_id: int = 3, to_id: int = 1, kind: LinkType = LinkType.GLOBAL_CLOSURE) -> Link:
    information = np.diag(np.arange(1.0, 7.0))
    information[0, 4] = information[4, 0] = 0.25
    return Link(from_id, to_id, kind, pose(4), information)


def test_both_directions_with_the_same_information(writer: MapWriter) -> None:
    link = loop(4, 1)
    writer.add_node(record(4, links=(*record(4).links, link)))
    found = {row[:2]: row[2:] for row in rows(writer.path)}
    assert set(found) == {(1, 2), (2, 1), (2, 3), (3, 2), (3, 4), (4, 3), (1, 4), (4, 1)}
    for (from_id, to_id), (kind, information, _) in found.items():
        assert found[to_id, from_id][:2] == (kind, information)
        assert len(information) == 288
    np.testing.assert_array_equal(unpack_information(found[4, 1][1]), link.information)
    assert link.T_from_to is not None
    for key, expected in (((4, 1), link.T_from_to), ((1, 4), inverse(link.T_from_to))):
        T_from_to = unpack_transform(found[key][2])
        assert T_from_to is not None
        np.testing.assert_array_equal(T_from_to, expected.astype(np.float32))


def test_links_are_read_once_from_the_newer_node(writer: MapWriter) -> None:
    writer.add_node(record(4, links=(replace(loop(1, 4)),)))
    (link,) = (link for link in MapReader(writer.path).links() if link.type == LinkType.GLOBAL_CLOSURE)
    assert (link.from_id, link.to_id) == (4, 1)
    assert link.T_from_to is not None
    np.testing.assert_allclose(link.T_from_to, inverse(pose(4)), atol=1e-6)


def test_a_merged_node_has_a_marker_in_one_direction(writer: MapWriter) -> None:
    node = replace(record(4).node, weight=WEIGHT_INVALID)
    writer.add_node(record(4, node=node, links=(), merged_into=3, weights={3: 5}))
    markers = [row for row in rows(writer.path) if 4 in row[:2]]
    assert [row[:3] for row in markers] == [(4, 3, LinkType.GLOBAL_CLOSURE)]
    assert markers[0][4] == bytes(48)
    np.testing.assert_array_equal(unpack_information(markers[0][3]), np.eye(6))
    reader = MapReader(writer.path)
    assert reader.links()[-1].T_from_to is None
    assert reader.nodes().weights.tolist() == [1, 2, 5, WEIGHT_INVALID]
    assert (reader.info().nodes, reader.info().dropped) == (3, 1)


def test_removed_links_go_in_both_directions(writer: MapWriter) -> None:
    writer.add_node(record(4, removed_links=((3, 2),)))
    assert {row[:2] for row in rows(writer.path)} == {(1, 2), (2, 1), (3, 4), (4, 3)}


def test_links_of_a_node_to_itself_and_landmarks_have_one_row(writer: MapWriter) -> None:
    links = (
        Link(4, 4, LinkType.GRAVITY, pose(4), np.eye(6)),
        Link(4, 4, LinkType.POSE_PRIOR, pose(4), np.eye(6)),
        Link(4, -7, LinkType.LANDMARK, pose(4), np.eye(6)),
    )
    writer.add_node(record(4, links=links))
    found = [row[:3] for row in rows(writer.path) if row[0] == 4]
    assert found == [(4, -7, 8), (4, 4, 7), (4, 4, 9)]
    assert len(MapReader(writer.path).links()) == 5


#: Of a row: its ids, its type, whether its information is sound, and what its transform is.
_TRANSFORMS = {"given": pack_transform(pose(4)), "null": bytes(48), "none": None, "broken": b"\x01" * 48}
any_row = st.tuples(
    st.integers(1, 3),
    st.integers(1, 3),
    st.sampled_from([LinkType.NEIGHBOR, LinkType.GLOBAL_CLOSURE, LinkType.GRAVITY]),
    st.sampled_from([True, True, False]),
    st.sampled_from(sorted(_TRANSFORMS)),
)


@settings(max_examples=40, deadline=None)
@given(st.lists(any_row, max_size=12))
def test_of_the_sound_rows_of_a_pair_the_last_from_the_newer_node_counts_else_the_last(
    table: list[tuple[int, int, LinkType, bool, str]],
) -> None:
    engine = create_engine("sqlite://")
    with engine.begin() as connection:
        connection.exec_driver_sql(
            "CREATE TABLE Link (from_id INT, to_id INT, type INT, information_matrix BLOB, transform BLOB)"
        )
        # The number of the row tells which one was taken.
        for k, (a, b, kind, sound, T) in enumerate(table):
            information = (np.eye(6) * (k + 1) * (1 if sound else -1)).tobytes()
            values = (a, b, int(kind), information, _TRANSFORMS[T])
            connection.exec_driver_sql(f"INSERT INTO {link_table.name} VALUES (?, ?, ?, ?, ?)", values)
        faults: Faults = {}
        found = read_links(connection, faults)
    engine.dispose()
    kept: dict[tuple[int, int, bool], int] = {}
    for k, (a, b, kind, sound, T) in enumerate(table):
        key = (min(a, b), max(a, b), kind is LinkType.GRAVITY)
        if sound and T != "broken" and (a > b or key not in kept or table[kept[key]][0] <= table[kept[key]][1]):
            kept[key] = k
    assert [round(link.information[0, 0]) - 1 for link in found] == [kept[key] for key in sorted(kept)]
    for link, k in zip(found, (kept[key] for key in sorted(kept)), strict=True):
        assert (link.from_id, link.to_id, link.type) == table[k][:3]
        assert (link.T_from_to is not None) == (table[k][4] == "given")
    bad = {f"{a}-{b}" for a, b, _, sound, T in table if not sound or T == "broken"}
    assert {fault.row for fault in faults} == bad


@pytest.mark.parametrize(
    ("link", "says"),
    [
        (loop(4, 9), "node 9 is not in the map"),
        (loop(3, 2), "link 3-2 exists already"),
        (loop(2, 3), "link 2-3 exists already"),
        (loop(4, 4), "links of a node to itself are priors and gravity"),
        (loop(4, -3), "landmarks, and only those, have negative ids"),
        (loop(4, 1, LinkType.VIRTUAL_CLOSURE), "virtual links are never saved"),
        (replace(loop(4, 1), information=np.zeros((6, 6))), "positive diagonal"),
        (replace(loop(4, 1), information=np.full((6, 6), np.nan)), "positive diagonal"),
        (replace(loop(4, 1), T_from_to=np.full((4, 4), np.nan)), "its transform is not finite"),
    ],
)
def test_what_rtabmap_would_not_load_is_refused_whole(writer: MapWriter, link: Link, says: str) -> None:
    before = rows(writer.path)
    with pytest.raises(DatabaseError, match=f"adding node 4 failed: .*{says}"):
        writer.add_node(record(4, links=(*record(4).links, link)))
    assert rows(writer.path) == before
    assert MapReader(writer.path).node_ids().tolist() == [1, 2, 3]
    assert MapReader(writer.path).words().ids.max() < 4000
    writer.add_node(record(4))
    assert len(MapReader(writer.path).links()) == 3


def test_a_link_that_is_not_there_can_t_be_removed(writer: MapWriter) -> None:
    with pytest.raises(DatabaseError, match="link 3-1 can't be removed"):
        writer.add_node(record(4, removed_links=((3, 1),)))


def test_killed_files_with_rows_missing_or_doubled_are_read(tmp_path: Path) -> None:
    path = write_map(tmp_path / "map.db", 4)
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("DELETE FROM Link WHERE from_id = 3 AND to_id = 2")
        connection.execute("INSERT INTO Link SELECT * FROM Link WHERE from_id = 4")
        connection.commit()
    links = MapReader(path).links()
    assert [(link.from_id, link.to_id) for link in links] == [(2, 1), (2, 3), (4, 3)]
    assert MapReader(path).info().links == {"Neighbor": 3}


def test_the_minimal_validation_of_the_writing_recipe(tmp_path: Path) -> None:
    """What makes RTAB-Map abort: two Admin rows, an information diagonal of 0, words or nodes missing, double links."""
    path = write_map(tmp_path / "map.db", 8)
    with closing(sqlite3.connect(path)) as connection:

        def one(query: str) -> Any:
            return connection.execute(query).fetchone()[0]

        assert one("SELECT COUNT(*) FROM Admin") == 1
        assert one("SELECT COUNT(*) FROM Info WHERE parameters IS NULL OR parameters = ''") == 0
        assert one("SELECT COUNT(*) FROM Feature WHERE word_id > 0 AND word_id NOT IN (SELECT id FROM Word)") == 0
        assert one("SELECT COUNT(*) FROM (SELECT 1 FROM Link GROUP BY from_id, to_id HAVING COUNT(*) > 1)") == 0
        for column in ("from_id", "to_id"):
            assert one(f"SELECT COUNT(*) FROM Link WHERE {column} NOT IN (SELECT id FROM Node)") == 0
        assert one("SELECT COUNT(*) FROM Word WHERE descriptor_size != LENGTH(descriptor)") == 0
        assert one("SELECT COUNT(*) FROM (SELECT DISTINCT descriptor IS NULL FROM Feature)") == 1
        assert one("SELECT COUNT(*) FROM Data WHERE calibration IS NULL") == 0
        assert one("SELECT COUNT(*) FROM Node WHERE label = ''") == 0
        for (information,) in connection.execute("SELECT information_matrix FROM Link"):
            assert (np.diag(unpack_information(information)) > 0).all()
        pragma = connection.execute("PRAGMA foreign_key_check").fetchall()
        assert pragma == []
