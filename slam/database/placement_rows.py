"""Rows of deck_placement: how entries of the journal placed all poses, to do it again where they are not kept."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, cast, get_args

import numpy as np
from sqlalchemy import Connection, insert, inspect, select

from slam.database.blobs import pack_pose, unpack_pose
from slam.database.deck_tables import placement
from slam.database.faults import Faults, each_sound, link_type_of, text_of, whole_of
from slam.errors import DatabaseError
from slam.geometry import Pose
from slam.types import KernelName, Manner, Placement, StartName

_NUMBERS = re.compile(r"(\d{1,3}( \d{1,3})*)?")


def insert_placement(connection: Connection, number: int, done: Placement) -> None:
    """Keep what entry ``number`` of the journal did."""
    manner = Manner() if done.manner is None else done.manner
    row = {
        "id": number,
        "T_new_old": pack_pose(done.T_new_old),
        "root": manner.root,
        "without": " ".join(str(int(kind)) for kind in manner.without),
        "solver": manner.solver,
        "kernel": manner.kernel,
        "start": manner.start,
        "step": done.step,
    }
    connection.execute(insert(placement), row)


def read_placements(connection: Connection, faults: Faults | None = None) -> Mapping[int, Placement]:
    """All placements by the number of their entry; none in files that were written before there were any.

    Rows that make no sense go to ``faults``.
    """
    if not inspect(connection).has_table(placement.name):
        return {}
    rows = connection.execute(select(placement).order_by(placement.c.id))
    return dict(each_sound(placement.name, rows, _placement, faults))


def _placement(row: Any) -> tuple[int, Placement]:
    if row.T_new_old is not None:
        return row.id, Placement(T_new_old=_rigid(row.T_new_old))
    without = text_of(row.without, "without")
    if not _NUMBERS.fullmatch(without):
        raise DatabaseError(f"without is {without[:40]!r}, and numbers of kinds of links are right")
    manner = Manner(
        root=_whole(row.root, "root"),
        without=tuple(link_type_of(int(text)) for text in without.split()),
        solver=_whole(row.solver, "solver", 2),
        kernel=None if row.kernel is None else cast(KernelName, _one_of(KernelName, row.kernel, "kernel")),
        start=cast(StartName, _one_of(StartName, row.start, "start")),
    )
    return row.id, Placement(manner=manner, step=_whole(row.step, "step"))


def _rigid(blob: object) -> Pose:
    T = unpack_pose(blob) if isinstance(blob, bytes) else None
    if T is None or not np.isfinite(T).all() or not np.allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-6):
        raise DatabaseError("T_new_old is no rigid transform")
    return T


def _whole(value: Any, name: str, most: int = 2**31 - 1) -> int | None:
    number = None if value is None else whole_of(value, name)
    if number is not None and not 0 <= number <= most:
        raise DatabaseError(f"{name} is {number}, and 0 to {most} is right")
    return number


def _one_of(kind: Any, value: Any, name: str) -> str:
    text = text_of(value, name)
    if text not in get_args(kind):
        raise DatabaseError(f"{name} is {text[:40]!r}, and {', '.join(get_args(kind))} are right")
    return text
