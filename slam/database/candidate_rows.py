"""Rows of deck_candidate: every loop closure that was looked at, with its evidence or the reason for its refusal."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from sqlalchemy import Connection, select

from slam.database.blobs import pack_pose, unpack_information, unpack_poses
from slam.database.deck_tables import candidate
from slam.database.deck_values import CandidateRow, LoopState
from slam.database.faults import Faults, each_sound, link_type_of, node_id_of, number_of, text_of, whole_of
from slam.database.insertion import insert_rows
from slam.database.journal_rows import read_standing
from slam.geometry import Pose
from slam.types import Candidate, Refusal

_COLUMNS = tuple(c for c in candidate.c.keys() if c != "id")  # noqa: SIM118 (columns, not a dictionary)
_DECIDED = {"approve": LoopState.APPROVED, "reject": LoopState.REJECTED, "add": LoopState.ADDED}


def insert_candidates(connection: Connection, update_id: int, candidates: Iterable[Candidate]) -> None:
    """Add the candidates of an update."""
    insert_rows(connection, candidate, _COLUMNS, [_row(update_id, item) for item in candidates])


def read_candidates(connection: Connection, after: int, faults: Faults | None = None) -> list[CandidateRow]:
    """The candidates after number ``after``, ascending, each with the decision about its pair that stands.

    Rows that make no sense go to ``faults``.
    """
    decided = {entry.pair: _DECIDED[entry.action] for entry in read_standing(connection, faults)}
    rows = connection.execute(select(candidate).where(candidate.c.id > after).order_by(candidate.c.id))
    found = rows.all()
    poses = zip((row.id for row in found), found, unpack_poses([row.transform for row in found]), strict=True)
    return list(each_sound(candidate.name, poses, lambda item: _candidate_row(item[1], item[2], decided), faults))


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


def _candidate_row(row: Any, T_from_to: Pose | None, decided: dict[tuple[int, int], LoopState]) -> CandidateRow:
    refusal = None
    if row.refusal_test is not None:
        value, threshold = (np.nan if v is None else float(v) for v in (row.refusal_value, row.refusal_threshold))
        refusal = Refusal(text_of(row.refusal_test, "test"), value, threshold, text_of(row.refusal_text, "text"))
    item = Candidate(
        from_id=node_id_of(row.from_id),
        to_id=node_id_of(row.to_id),
        type=link_type_of(row.type),
        posterior=np.nan if row.posterior is None else number_of(row.posterior, "posterior"),
        matches=whole_of(row.matches, "matches"),
        inliers=whole_of(row.inliers, "inliers"),
        T_from_to=T_from_to,
        information=None if row.information is None else unpack_information(row.information),
        refusal=refusal,
    )
    outcome = LoopState.ACCEPTED if refusal is None else LoopState.REFUSED
    pair = (min(row.from_id, row.to_id), max(row.from_id, row.to_id))
    return CandidateRow(row.id, whole_of(row.update_id, "update_id"), item, decided.get(pair, outcome))
