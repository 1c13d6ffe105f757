"""Making the rows of a map file fit together again."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slam.database.blobs import pack_transform, unpack_transform
from slam.database.file_check import WRITTEN_VERSION
from slam.database.refusal import refusing
from slam.geometry import inverse

#: Bytes of a link's information, and of a transform.
_INFORMATION, _TRANSFORM = 288, 48
_WITH_NODE = {"Data": "id", "Feature": "node_id", "GlobalDescriptor": "node_id"}
_SINCE = (("Admin", "dictionary_index", "0.23.0"), ("Data", "depth_confidence", "0.22.0"))


@dataclass(frozen=True, slots=True)
class Mended:
    """What was done.

    Attributes:
        reversed: links whose reverse row was written again.
        dropped_links: links with a node that is gone, or that are no links any more.
        dropped_rows: rows of nodes that are gone, by table.
        words: words made again of the descriptors of key points.
        lost_words: words that no key point has a descriptor of; these key points count as none any more.
        version: given to a file that had lost it, empty where it had not.
        parameters: whether parameters had to be given.
    """

    reversed: tuple[tuple[int, int], ...]
    dropped_links: tuple[tuple[int, int], ...]
    dropped_rows: dict[str, int]
    words: int
    lost_words: int
    version: str
    parameters: bool


def mend(path: Path, parameters: str) -> Mended:
    """Drop what refers to nothing, restore reverse links and words; ``parameters`` is for a file that has lost its own.

    Raises:
        DatabaseError: the file can't be read or written.
    """
    with refusing(path, "mending"), closing(sqlite3.connect(path, isolation_level=None)) as connection:
        connection.execute("PRAGMA journal_mode=OFF")
        connection.execute("BEGIN")
        version = _version(connection)
        rows = {table: _drop_orphans(connection, table, column) for table, column in _WITH_NODE.items()}
        dropped = _drop_links(connection)
        made, lost = _words(connection)
        given = not connection.execute("SELECT 1 FROM Info WHERE coalesce(parameters, '') <> ''").fetchone()
        if given:
            connection.execute(
                "INSERT INTO Info (STM_size, last_sign_added, parameters) SELECT count(*), max(id), ? FROM Node",
                (parameters,),
            )
            connection.execute("UPDATE Node SET time_enter = (SELECT max(time_enter) FROM Info) WHERE weight > -9")
            connection.execute("UPDATE Word SET time_enter = (SELECT max(time_enter) FROM Info)")
        mended = Mended(
            _reverse(connection),
            dropped,
            {table: count for table, count in rows.items() if count},
            made,
            lost,
            version,
            given,
        )
        connection.execute("COMMIT")
        return mended


def _version(connection: sqlite3.Connection) -> str:
    if connection.execute("SELECT 1 FROM Admin WHERE coalesce(version, '') <> ''").fetchone():
        connection.execute("DELETE FROM Admin WHERE rowid > (SELECT min(rowid) FROM Admin WHERE version <> '')")
        return ""
    version = WRITTEN_VERSION
    for table, column, since in reversed(_SINCE):
        if column in {row[1] for row in connection.execute(f"PRAGMA table_info({table})")}:
            version = since
    connection.execute("DELETE FROM Admin")
    connection.execute("INSERT INTO Admin (version) VALUES (?)", (version,))
    return version


def _drop_orphans(connection: sqlite3.Connection, table: str, column: str) -> int:
    if not connection.execute("SELECT 1 FROM sqlite_master WHERE name = ?", (table,)).fetchone():
        return 0
    return connection.execute(f"DELETE FROM {table} WHERE {column} NOT IN (SELECT id FROM Node)").rowcount


def _drop_links(connection: sqlite3.Connection) -> tuple[tuple[int, int], ...]:
    bad = (
        "from_id NOT IN (SELECT id FROM Node) OR (to_id > 0 AND to_id NOT IN (SELECT id FROM Node))"
        f" OR length(information_matrix) <> {_INFORMATION} OR length(transform) <> {_TRANSFORM}"
    )
    found = connection.execute(f"SELECT DISTINCT from_id, to_id FROM Link WHERE {bad} ORDER BY from_id, to_id")
    pairs = tuple((int(a), int(b)) for a, b in found)
    connection.execute(f"DELETE FROM Link WHERE {bad}")
    return pairs


def _words(connection: sqlite3.Connection) -> tuple[int, int]:
    """Number of words made of key points' descriptors, and of words that are gone."""
    missing = (
        "word_id > 0 AND word_id NOT IN (SELECT id FROM Word) AND node_id IN (SELECT id FROM Node WHERE weight > -9)"
    )
    made = connection.execute(
        "INSERT INTO Word (id, descriptor_size, descriptor) SELECT word_id, descriptor_size, descriptor FROM Feature "
        f"WHERE {missing} AND descriptor_size > 0 AND descriptor IS NOT NULL GROUP BY word_id"
    ).rowcount
    lost = connection.execute(f"SELECT count(DISTINCT word_id) FROM Feature WHERE {missing}").fetchone()[0]
    connection.execute(f"UPDATE Feature SET word_id = -rowid WHERE {missing}")
    return made, int(lost)


def _reverse(connection: sqlite3.Connection) -> tuple[tuple[int, int], ...]:
    rows = connection.execute(
        "SELECT from_id, to_id, type, information_matrix, transform FROM Link AS one WHERE to_id > 0 "
        "AND from_id <> to_id AND transform IS NOT NULL AND NOT EXISTS "
        "(SELECT 1 FROM Link AS other WHERE other.from_id = one.to_id AND other.to_id = one.from_id) "
        "ORDER BY from_id, to_id"
    ).fetchall()
    done = []
    for from_id, to_id, kind, information, transform in rows:
        T = unpack_transform(transform)
        if T is not None and np.isfinite(T).all():
            row = (to_id, from_id, kind, information, pack_transform(inverse(T)))
            connection.execute(
                "INSERT INTO Link (from_id, to_id, type, information_matrix, transform) VALUES (?,?,?,?,?)", row
            )
            done.append((int(from_id), int(to_id)))
    return tuple(done)
