"""Rows of deck_journal: people's decisions, only ever added; an entry that undoes another says so."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from sqlalchemy import Connection, Select, insert, inspect, null, select

from slam.database.blobs import pack_information, pack_pose, unpack_information, unpack_pose
from slam.database.deck_tables import decision, journal
from slam.database.faults import Faults, each_sound, link_type_of, number_of, text_of, whole_of
from slam.database.grid_change_rows import read_grid_changes, write_grids
from slam.database.node_change_rows import read_changes, write_change
from slam.database.placement_rows import insert_placement, read_placements
from slam.database.records import JournalEntry
from slam.database.setting_rows import insert_setting, read_settings
from slam.errors import DatabaseError
from slam.types import Link

#: What is said of loops, and what is done to links and nodes.
VERDICTS = ("approve", "reject", "add")
EDITS = ("refine", "edit", "covariance", "reset", "cut", "bridge", "prior", "drop", "label")
#: What is done to the poses alone.
PLACEMENTS = ("optimise", "turn")
#: Decisions, and the actions that take one of them (or an undo) back.
DECISIONS = (*VERDICTS, *EDITS, *PLACEMENTS, "regrid")
_TAKES_BACK = {"undo": DECISIONS, "redo": ("undo",)}


def append_entry(connection: Connection, entry: JournalEntry) -> int:
    """Add an entry; its number. An undo or redo without ``undoes`` takes back the last entry of its pair that stands.

    Raises:
        DatabaseError: the action is unknown, or there is nothing to take back.
    """
    if entry.action not in (*DECISIONS, *_TAKES_BACK):
        raise DatabaseError(f"decision {entry.action!r} is unknown: {', '.join((*DECISIONS, *_TAKES_BACK))} are known")
    undoes = entry.undoes
    if entry.action in _TAKES_BACK and undoes is None:
        undoes = _last_standing(connection, entry)
    row = insert(journal).values(
        time=entry.time or time.time(),
        author=entry.author,
        action=entry.action,
        from_id=entry.from_id,
        to_id=entry.to_id,
        note=entry.note,
        undoes=undoes,
        chi2_before=entry.chi2_before,
        chi2_after=entry.chi2_after,
        moved=entry.moved,
        max_shift_m=entry.max_shift_m,
        **_link_values("before", entry.link_before),
        **_link_values("after", entry.link_after),
    )
    (number,) = connection.execute(row.returning(journal.c.id)).one()
    return int(number)


def append_together(connection: Connection, entries: Sequence[JournalEntry]) -> list[int]:
    """Add entries that are one batch where they are several; their numbers. Raises like ``append_entry``."""
    if not entries:
        return []
    numbers = [append_entry(connection, entry) for entry in entries]
    batch = numbers[0] if len(numbers) > 1 else None
    rows = [
        {"id": number, "batch": batch, "ate_before": entry.ate_before, "ate_after": entry.ate_after}
        for number, entry in zip(numbers, entries, strict=True)
    ]
    connection.execute(insert(decision), rows)
    for number, entry in zip(numbers, entries, strict=True):
        if entry.node is not None:
            write_change(connection, number, entry.node)
        if entry.setting is not None:
            insert_setting(connection, number, entry.setting)
        if entry.placement is not None:
            insert_placement(connection, number, entry.placement)
        if entry.grids is not None:
            write_grids(connection, number, entry.grids)
    return numbers


def read_journal(connection: Connection, faults: Faults | None = None) -> list[JournalEntry]:
    """All entries, oldest first. An entry is undone while an entry that takes it back stands itself.

    Rows that make no sense go to ``faults``.
    """
    changes, settings = read_changes(connection), read_settings(connection, faults)
    placements, grids = read_placements(connection, faults), read_grid_changes(connection, faults)
    entries = [
        replace(
            entry,
            node=changes.get(entry.id),
            setting=settings.get(entry.id),
            placement=placements.get(entry.id),
            grids=grids.get(entry.id),
        )
        for entry in each_sound(journal.name, connection.execute(_all(connection)), _entry, faults)
    ]
    undone_by: dict[int, int] = {}
    for entry in reversed(entries):
        if entry.undoes is not None and entry.id not in undone_by:
            undone_by[entry.undoes] = entry.id
    return [replace(entry, undone_by=undone_by.get(entry.id)) for entry in entries]


def read_standing(connection: Connection, faults: Faults | None = None) -> list[JournalEntry]:
    """The verdicts that stand, oldest first: neither undone nor entries that undo."""
    return [entry for entry in read_journal(connection, faults) if entry.action in VERDICTS and entry.undone_by is None]


def _all(connection: Connection) -> Select[Any]:
    more = [decision.c.batch, decision.c.ate_before, decision.c.ate_after]
    if inspect(connection).has_table(decision.name):
        joined = journal.outerjoin(decision, decision.c.id == journal.c.id)
        return select(journal, *more).select_from(joined).order_by(journal.c.id)
    return select(journal, *(null().label(column.name) for column in more)).order_by(journal.c.id)


def _last_standing(connection: Connection, entry: JournalEntry) -> int:
    actions = _TAKES_BACK[entry.action]
    for earlier in reversed(read_journal(connection)):
        if earlier.pair == entry.pair and earlier.action in actions and earlier.undone_by is None:
            return earlier.id
    raise DatabaseError(f"nothing to {entry.action} about link {entry.from_id}-{entry.to_id}: no such entry stands")


def _link_values(when: str, item: Link | None) -> dict[str, Any]:
    if item is None:
        return {}
    return {
        f"type_{when}": int(item.type),
        f"transform_{when}": pack_pose(item.T_from_to),
        f"information_{when}": pack_information(item.information),
    }


def _entry(row: Any) -> JournalEntry:
    if row.action not in (*DECISIONS, *_TAKES_BACK):
        raise DatabaseError(f"decision {str(row.action)[:40]!r} is unknown")
    return JournalEntry(
        id=row.id,
        time=number_of(row.time, "time"),
        author=text_of(row.author, "author"),
        action=row.action,
        from_id=whole_of(row.from_id, "from_id"),
        to_id=whole_of(row.to_id, "to_id"),
        link_before=_link(row, row.type_before, row.transform_before, row.information_before),
        link_after=_link(row, row.type_after, row.transform_after, row.information_after),
        note=text_of(row.note, "note"),
        undoes=None if row.undoes is None else whole_of(row.undoes, "undoes"),
        chi2_before=None if row.chi2_before is None else float(row.chi2_before),
        chi2_after=None if row.chi2_after is None else float(row.chi2_after),
        moved=whole_of(row.moved, "moved"),
        max_shift_m=number_of(row.max_shift_m, "max_shift_m"),
        ate_before=None if row.ate_before is None else number_of(row.ate_before, "ate_before"),
        ate_after=None if row.ate_after is None else number_of(row.ate_after, "ate_after"),
        batch=None if row.batch is None else whole_of(row.batch, "batch"),
    )


def _link(row: Any, kind: int | None, transform: bytes | None, information: bytes | None) -> Link | None:
    if kind is None:
        return None
    return Link(row.from_id, row.to_id, link_type_of(kind), unpack_pose(transform), unpack_information(information))
