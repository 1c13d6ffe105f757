"""Copying a map file without some of its nodes, row for row."""

from __future__ import annotations

import sqlite3
from collections.abc import Collection, Sequence
from contextlib import closing
from pathlib import Path

from slam.database.blobs import pack_information, pack_transform
from slam.database.connection import BUSY_SECONDS, read_only_uri
from slam.database.refusal import refusing
from slam.geometry import inverse
from slam.types import Link

#: Tables whose rows belong to a node, and the column that names it.
_OF_NODE = {
    "Node": "id",
    "Data": "id",
    "Feature": "node_id",
    "GlobalDescriptor": "node_id",
    "Statistics": "id",
    "deck_update": "id",
    "deck_hypothesis": "update_id",
    "deck_candidate": "update_id",
    "deck_frame": "node_id",
    "deck_pose": "id",
}
_MESH = ("opt_cloud", "opt_polygons_size", "opt_polygons", "opt_tex_coords", "opt_tex_materials")
_DERIVED = (*_MESH, "opt_map", "opt_map_x_min", "opt_map_y_min", "opt_map_resolution")


def copy_without(
    source: Path, target: Path, dropped: Collection[int], bridges: Sequence[Link], *, images: bool
) -> None:
    """Copy a map file and take nodes out of the copy; what stays is equal to the original's rows.

    Args:
        source: map file; not changed.
        target: file to make.
        dropped: ids of nodes that go, with all that is theirs and their links; journal and parameters stay whole.
        bridges: links of odometry over the gaps that they leave.
        images: whether colour and depth images stay.

    Raises:
        DatabaseError: a file can't be read or written.
    """
    with refusing(source, "copying"), closing(sqlite3.connect(target, isolation_level=None)) as copy:
        with closing(sqlite3.connect(read_only_uri(source), uri=True, timeout=BUSY_SECONDS)) as original:
            original.backup(copy)
        copy.execute("PRAGMA journal_mode=OFF")
        copy.execute("BEGIN")
        tables = {name for (name,) in copy.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
        if dropped:
            _drop(copy, tables, dropped)
        for link in bridges:
            _insert_bridge(copy, link)
        if not images:
            copy.execute("UPDATE Data SET image = NULL, depth = NULL")
        if not images and "depth_confidence" in {row[1] for row in copy.execute("PRAGMA table_info(Data)")}:
            copy.execute("UPDATE Data SET depth_confidence = NULL")
        copy.execute("COMMIT")
        copy.execute("VACUUM")


def _drop(copy: sqlite3.Connection, tables: set[str], dropped: Collection[int]) -> None:
    copy.execute("CREATE TEMP TABLE gone (id INTEGER PRIMARY KEY)")
    copy.executemany("INSERT INTO gone VALUES (?)", [(node_id,) for node_id in dropped])
    for table in sorted(tables & _OF_NODE.keys()):
        copy.execute(f"DELETE FROM {table} WHERE {_OF_NODE[table]} IN (SELECT id FROM gone)")
    copy.execute("DELETE FROM Link WHERE from_id IN (SELECT id FROM gone) OR to_id IN (SELECT id FROM gone)")
    copy.execute("DELETE FROM Word WHERE id NOT IN (SELECT word_id FROM Feature)")
    # Made of all nodes; the grid is made anew of those that stay.
    copy.execute(f"UPDATE Admin SET {', '.join(f'{column} = NULL' for column in _DERIVED)}")


def _insert_bridge(copy: sqlite3.Connection, link: Link) -> None:
    assert link.T_from_to is not None
    information = pack_information(link.information)
    for a, b, T in ((link.from_id, link.to_id, link.T_from_to), (link.to_id, link.from_id, inverse(link.T_from_to))):
        row = (a, b, int(link.type), information, pack_transform(T))
        copy.execute("INSERT INTO Link (from_id, to_id, type, information_matrix, transform) VALUES (?,?,?,?,?)", row)
