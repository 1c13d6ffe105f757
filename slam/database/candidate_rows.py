"""Rows of deck_candidate: every loop closure that was looked at, with its evidence or the reason for its refusal."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from sqlalchemy import Connection, Row, select

from slam.database.blobs import pack_pose, unpack_information, unpack_pose
from slam.database.deck_tables import candidate
from slam.database.deck_values import CandidateRow, LoopState
from slam.database.insertion import insert_rows
from slam.database.journal_rows import read_standing
from slam.types import Candidate, LinkType, Refusal

_COLUMNS = tuple(c for c in candidate.c.keys() if c != "id")  # noqa: SIM118 (columns, not a dictionary)
_DECIDED = {"approve": LoopState.APPROVED, "reject": LoopState.REJECTED, "add": LoopState.ADDED}


def insert_candidates(connection: Connection, update_id: int, candidates: Iterable[Candidate]) -> None:
    """Add the candidates of an update."""
    insert_rows(connection, candidate, _COLUMNS, [_row(update_id, item) for item in candidates])


def read_candidates(connection: Connection, after: int) -> list[CandidateRow]:
    """The candidates after number ``after``, ascending, each with the decision about its pair that stands."""
    decided = {entry.pair: _DECIDED[entry.action] for entry in read_standing(connection)}
    rows = connection.execute(select(candidate).where(candidate.c.id > after).order_by(candidate.c.id))
    return [_candidate_row(row, decided) for row in rows]


def _row(update_id: int, item: Candidate) -> tuple[Any, ...]:
    information = item.information
    refusal = item.refusal
    return (
        update_id,
        item.from_id,
        item.to_id,
        int(item.type),
        item.posterior,
        item.matches,
        item.inliers,
        pack_pose(item.T_from_to),
        None if information is None else np.ascontiguousarray(information, dtype="<f8").tobytes(),
        *((None,) * 4 if refusal is None else (refusal.test, refusal.value, refusal.threshold, refusal.text)),
    )


def _candidate_row(row: Row[Any], decided: dict[tuple[int, int], LoopState]) -> CandidateRow:
    refusal = None
    if row.refusal_test is not None:
        value, threshold = (np.nan if v is None else v for v in (row.refusal_value, row.refusal_threshold))
        refusal = Refusal(row.refusal_test, value, threshold, row.refusal_text)
    item = Candidate(
        from_id=row.from_id,
        to_id=row.to_id,
        type=LinkType(row.type),
        posterior=np.nan if row.posterior is None else row.posterior,
        matches=row.matches,
        inliers=row.inliers,
        T_from_to=unpack_pose(row.transform),
        information=None if row.information is None else unpack_information(row.information),
        refusal=refusal,
    )
    outcome = LoopState.ACCEPTED if refusal is None else LoopState.REFUSED
    pair = (min(row.from_id, row.to_id), max(row.from_id, row.to_id))
    return CandidateRow(row.id, row.update_id, item, decided.get(pair, outcome))
