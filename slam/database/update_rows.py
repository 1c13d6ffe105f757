"""Rows of deck_update and deck_hypothesis: what each map update decided and believed."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import Connection, insert, select

from slam.database.blobs import pack_pose, unpack_poses
from slam.database.deck_tables import hypothesis, update
from slam.database.deck_values import UpdateRow
from slam.database.faults import Faults, each_sound, node_id_of, number_of, text_of, whole_of
from slam.database.insertion import insert_rows
from slam.errors import DatabaseError
from slam.geometry import Pose
from slam.types import Posterior, Tier, Update

#: Places kept of each belief: the most probable ones. The virtual place comes on top, under this id.
KEPT_PLACES = 20
VIRTUAL_PLACE_ID = -1


def insert_update(connection: Connection, node_id: int, item: Update) -> None:
    """Add the update that made a node, with the best hypotheses of its belief."""
    belief = item.posterior
    connection.execute(
        insert(update).values(
            id=node_id,
            frame_index=item.frame_index,
            stamp=item.stamp,
            weight=item.weight,
            T_map_base=pack_pose(item.T_map_base),
            best_id=0 if belief is None else belief.best_id,
            value=None if belief is None else belief.value,
            virtual_place=None if belief is None else belief.virtual_place,
            optimized=item.optimized,
            tiers=json.dumps({str(place): tier.value for place, tier in sorted(item.tiers.items())}),
            matches=item.odometry.matches,
            inliers=item.odometry.inliers,
            keyframe=item.odometry.keyframe,
            odometry_ms=item.odometry.time_ms,
            time_ms=item.time_ms,
        )
    )
    if belief is not None:
        _insert_belief(connection, node_id, belief)


def read_updates(connection: Connection, after: int, faults: Faults | None = None) -> list[UpdateRow]:
    """The updates after node ``after``, ascending. Rows that make no sense go to ``faults``."""
    rows = connection.execute(select(update).where(update.c.id > after).order_by(update.c.id)).all()
    poses = zip((row.id for row in rows), rows, unpack_poses([row.T_map_base for row in rows]), strict=True)
    return list(each_sound(update.name, poses, lambda item: _update_row(item[1], item[2]), faults))


def read_belief(connection: Connection, update_id: int) -> Posterior | None:
    """The best places of an update's belief, ascending by id, and the virtual place; None where it had none."""
    query = select(hypothesis.c.place_id, hypothesis.c.likelihood, hypothesis.c.probability)
    rows = connection.execute(query.where(hypothesis.c.update_id == update_id).order_by(hypothesis.c.place_id)).all()
    if not rows:
        return None
    places = [row for row in rows if row.place_id != VIRTUAL_PLACE_ID]
    (virtual,) = (row for row in rows if row.place_id == VIRTUAL_PLACE_ID)
    return Posterior(
        node_ids=np.array([row.place_id for row in places], dtype=np.int32),
        likelihood=np.array([_number(row.likelihood) for row in places], dtype=np.float64),
        probability=np.array([_number(row.probability) for row in places], dtype=np.float64),
        virtual_place=_number(virtual.probability),
        virtual_likelihood=_number(virtual.likelihood),
    )


def read_beliefs(connection: Connection, after: int) -> dict[int, Posterior]:
    """The same for every update after a node that had one, by the update's id."""
    columns = (hypothesis.c.update_id, hypothesis.c.place_id, hypothesis.c.likelihood, hypothesis.c.probability)
    query = select(*columns).where(hypothesis.c.update_id > after).order_by(columns[0], columns[1])
    values = np.array([tuple(row) for row in connection.execute(query)], dtype=np.float64).reshape(-1, 4)
    ids, starts = np.unique(values[:, 0], return_index=True)
    parts = np.split(values[:, 1:], starts[1:]) if len(ids) else []
    return {int(update_id): _belief(part) for update_id, part in zip(ids, parts, strict=True)}


def _belief(rows: NDArray[np.float64]) -> Posterior:
    """From rows (N, 3) of place, likelihood and probability."""
    virtual = rows[:, 0] == VIRTUAL_PLACE_ID
    places, (nowhere,) = rows[~virtual], rows[virtual]
    return Posterior(places[:, 0].astype(np.int32), places[:, 1], places[:, 2], float(nowhere[2]), float(nowhere[1]))


def _insert_belief(connection: Connection, node_id: int, belief: Posterior) -> None:
    best = _best_rows(belief)
    ids, likelihood, probability = (
        values[best].tolist() for values in (belief.node_ids, belief.likelihood, belief.probability)
    )
    rows = [(node_id, *row) for row in zip(ids, likelihood, probability, strict=True)]
    rows.append((node_id, VIRTUAL_PLACE_ID, belief.virtual_likelihood, belief.virtual_place))
    insert_rows(connection, hypothesis, ("update_id", "place_id", "likelihood", "probability"), rows)


def _best_rows(belief: Posterior) -> NDArray[np.intp]:
    order = np.argsort(-belief.probability, kind="stable")
    return order[:KEPT_PLACES]


def _update_row(row: Any, T_map_base: Pose | None) -> UpdateRow:
    return UpdateRow(
        id=node_id_of(row.id),
        frame_index=whole_of(row.frame_index, "frame_index"),
        stamp=number_of(row.stamp, "stamp"),
        weight=whole_of(row.weight, "weight"),
        T_map_base=T_map_base,
        best_id=whole_of(row.best_id, "best_id"),
        value=_number(row.value),
        virtual_place=_number(row.virtual_place),
        optimized=bool(row.optimized),
        tiers=_tiers(row.tiers),
        matches=whole_of(row.matches, "matches"),
        inliers=whole_of(row.inliers, "inliers"),
        keyframe=bool(row.keyframe),
        odometry_ms=number_of(row.odometry_ms, "odometry_ms"),
        time_ms=number_of(row.time_ms, "time_ms"),
    )


def _tiers(text: object) -> dict[int, Tier]:
    said = json.loads(text_of(text, "tiers"))
    if not isinstance(said, dict):
        raise DatabaseError(f"tiers is {str(said)[:40]!r}, not an object of node ids")
    return {int(place): Tier(tier) for place, tier in said.items()}


def _number(value: float | None) -> float:
    return np.nan if value is None else float(value)
