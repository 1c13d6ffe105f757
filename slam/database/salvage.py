"""Copying every row that can still be read from a damaged map file into a new one."""

from __future__ import annotations

import sqlite3
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass, field
from mmap import ACCESS_READ, mmap
from pathlib import Path

from slam.database.new_file import create_file
from slam.database.pages import INDEX_LEAF, LEAF, Cell, Gap, Lost, Pages, Value
from slam.errors import DatabaseError

#: Rows of the schema: type, name, table, root, SQL.
_SCHEMA_COLUMNS = 5


@dataclass(slots=True)
class Salvaged:
    """What came of it.

    Attributes:
        rows: number of rows copied, by table.
        gaps: numbers of the rows whose page is gone, by table, in words.
        cut: rows that lost columns, by table, in words.
        unreadable: number of rows that were not even a row any more, by table.
        found: number of rows found on pages that no tree led to, by table.
    """

    rows: Counter[str] = field(default_factory=Counter)
    gaps: dict[str, list[str]] = field(default_factory=dict)
    cut: dict[str, list[str]] = field(default_factory=dict)
    unreadable: Counter[str] = field(default_factory=Counter)
    found: Counter[str] = field(default_factory=Counter)


@dataclass(frozen=True, slots=True)
class _Table:
    """A table of the new file: its columns, which of them may not be NULL, and the one that is the row's number."""

    name: str
    columns: tuple[str, ...]
    needed: tuple[bool, ...]
    kinds: tuple[str, ...]
    alias: int | None


def salvage(source: Path, target: Path) -> Salvaged:
    """Make a map file of all rows that can be read, with the tables that the damaged one has.

    Rows are read page by page; a page that no tree leads to any more belongs to the one table that its rows fit.

    Raises:
        DatabaseError: the file holds no row of a map.
    """
    done = Salvaged()
    with source.open("rb") as file, mmap(file.fileno(), 0, access=ACCESS_READ) as content:
        pages, seen = Pages(content), set[int]()
        schema = _schema(pages, seen)
        create_file(target)
        with closing(sqlite3.connect(target, isolation_level=None)) as copy:
            copy.execute("PRAGMA journal_mode=OFF")
            copy.execute("BEGIN")
            _prepare(copy, schema)
            tables = {name: _table(copy, name) for name in _names(copy)}
            triggers = copy.execute("SELECT name, sql FROM sqlite_master WHERE type = 'trigger'").fetchall()
            for name, _ in triggers:
                copy.execute(f"DROP TRIGGER {name}")
            for name, table in tables.items():
                if name in schema:
                    _insert(copy, table, _rows(pages, table, schema[name][0], seen, done), done)
            _insert_orphans(copy, pages, tables, schema, seen, done)
            for _, sql in triggers:
                copy.execute(sql)
            copy.execute("COMMIT")
    if not done.rows["Node"]:
        raise DatabaseError(f"{source}: no node could be read: it is no map file, or nothing of it is left")
    return done


def _schema(pages: Pages, seen: set[int]) -> dict[str, tuple[int, str]]:
    """Table -> root page and SQL, as far as it can be read."""
    found = {}
    for part in pages.leaves(1, seen):
        for cell in pages.cells(part) if isinstance(part, int) else ():
            if cell is not None and len(cell.values) == _SCHEMA_COLUMNS:
                kind, name, _, root, sql = cell.values
                if kind == "table" and isinstance(name, str) and isinstance(root, int) and isinstance(sql, str):
                    found[name] = root, sql
    return found


def _prepare(copy: sqlite3.Connection, schema: dict[str, tuple[int, str]]) -> None:
    """The new file's tables get the columns of the old one's, newer and older versions have others."""
    copy.execute("DELETE FROM Admin")
    for name, (_, sql) in schema.items():
        indexes = copy.execute(
            "SELECT sql FROM sqlite_master WHERE tbl_name = ? AND type <> 'table'", (name,)
        ).fetchall()
        if name.startswith("sqlite_") or not sql.upper().startswith("CREATE TABLE"):
            continue
        copy.execute(f'DROP TABLE IF EXISTS "{name}"')
        copy.execute(sql)
        for (index,) in indexes:
            if index is not None:
                copy.execute(index)


def _names(copy: sqlite3.Connection) -> list[str]:
    query = "SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite_%' ORDER BY name"
    # Key points are refused before their nodes are there.
    return sorted((name for (name,) in copy.execute(query)), key=lambda name: (name != "Node", name))


def _table(copy: sqlite3.Connection, name: str) -> _Table:
    columns = copy.execute(f'PRAGMA table_info("{name}")').fetchall()
    keys = [row[0] for row in columns if row[5]]
    alias = keys[0] if len(keys) == 1 and columns[keys[0]][2].upper() == "INTEGER" else None
    return _Table(
        name,
        tuple(row[1] for row in columns),
        tuple(bool(row[3]) for row in columns),
        tuple(row[2].upper() for row in columns),
        alias,
    )


def _rows(pages: Pages, table: _Table, root: int, seen: set[int], done: Salvaged) -> Iterator[tuple[Value, ...]]:
    for part in pages.leaves(root, seen):
        if isinstance(part, Gap):
            end = "the end" if part.last is None else str(part.last)
            done.gaps.setdefault(table.name, []).append(f"rows {part.after + 1} to {end}")
            continue
        for cell in pages.cells(part):
            values = None if cell is None else _fitted(cell, table)
            if cell is None or values is None:
                done.unreadable[table.name] += 1
                continue
            yield _whole(cell.rowid, values, table, done)


def _fitted(cell: Cell, table: _Table) -> tuple[Value, ...] | None:
    """The row's values, one for each column; None where it can't be a row of this table."""
    values = list(cell.values)
    if not values or len(values) > len(table.columns):
        return None
    # Columns that were added later are not in older rows.
    values += [None] * (len(table.columns) - len(values))
    if table.alias is not None and values[table.alias] is None:
        values[table.alias] = cell.rowid
    for value, needed, kind in zip(values, table.needed, table.kinds, strict=True):
        if (value is None or value is Lost.LOST) and needed:
            return None
        if not _is_of(value, kind):
            return None
    return tuple(values)


def _is_of(value: Value, kind: str) -> bool:
    if value is None or value is Lost.LOST:
        return True
    if kind in ("INTEGER", "BOOLEAN"):
        return isinstance(value, int)
    if kind == "FLOAT":
        return isinstance(value, int | float)
    return isinstance(value, bytes) if kind == "BLOB" else isinstance(value, str | bytes)


def _whole(rowid: int, values: tuple[Value, ...], table: _Table, done: Salvaged) -> tuple[Value, ...]:
    lost = [name for name, value in zip(table.columns, values, strict=True) if value is Lost.LOST]
    if lost:
        done.cut.setdefault(table.name, []).append(f"{rowid}: {', '.join(lost)}")
    return tuple(None if value is Lost.LOST else value for value in values)


def _insert(copy: sqlite3.Connection, table: _Table, rows: Iterable[tuple[Value, ...]], done: Salvaged) -> int:
    names = ", ".join(f'"{name}"' for name in table.columns)
    marks = ", ".join("?" * len(table.columns))
    before = copy.execute(f'SELECT count(*) FROM "{table.name}"').fetchone()[0]
    copy.executemany(f'INSERT OR IGNORE INTO "{table.name}" ({names}) VALUES ({marks})', rows)
    added = copy.execute(f'SELECT count(*) FROM "{table.name}"').fetchone()[0] - before
    done.rows[table.name] += added
    return int(added)


def _insert_orphans(
    copy: sqlite3.Connection,
    pages: Pages,
    tables: dict[str, _Table],
    schema: dict[str, tuple[int, str]],
    seen: set[int],
    done: Salvaged,
) -> None:
    """Rows of pages that no tree leads to: the pages above them are gone, or the schema is."""
    if not done.gaps and schema.keys() >= tables.keys():
        return
    left = set(range(2, pages.count + 1)) - seen - pages.free()
    damaged = [table for name, table in tables.items() if name in done.gaps or name not in schema]
    for number in sorted(n for n in left if pages.kind(n) in (LEAF, INDEX_LEAF)):
        cells = list(pages.cells(number))
        fitting = [table for table in damaged if _all_fit(cells, table)]
        if len(fitting) == 1:
            rows = [
                _whole(cell.rowid, values, fitting[0], done)
                for cell in cells
                if cell is not None and (values := _fitted(cell, fitting[0])) is not None
            ]
            done.found[fitting[0].name] += _insert(copy, fitting[0], rows, done)


def _all_fit(cells: list[Cell | None], table: _Table) -> bool:
    return bool(cells) and all(
        cell is not None and len(cell.values) == len(table.columns) and _fitted(cell, table) is not None
        for cell in cells
    )
