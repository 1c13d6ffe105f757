"""What the 3D view draws, as arrays, made from a snapshot of the map."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from server.browse.snapshot import Pair, Snapshot
from slam.geometry import Pose
from slam.types import Link, Tier

Array = NDArray[np.float64]
_TIERS = tuple(Tier)


@dataclass(frozen=True, slots=True, eq=False)
class SceneModel:
    """The nodes that have a pose, ascending by id, and the links between them.

    Attributes:
        ids: (N,) node ids.
        T_map_base: (N, 4, 4).
        T_odom_base: (N, 4, 4), NaN where unknown.
        T_world_base: (N, 4, 4), NaN where unknown.
        map_ids: (N,).
        weights: (N,).
        stamps: (N,).
        tiers: (N,) positions in ``Tier``.
        rows: id -> row.
        links: links whose nodes both have a pose.
        refused: pairs that were looked at as a global loop and refused.
        step: typical distance in metres between neighbours, by which things are sized.
    """

    ids: NDArray[np.int32]
    T_map_base: Array
    T_odom_base: Array
    T_world_base: Array
    map_ids: NDArray[np.int32]
    weights: NDArray[np.int32]
    stamps: Array
    tiers: NDArray[np.int8]
    rows: dict[int, int]
    links: tuple[Link, ...]
    refused: tuple[Pair, ...]
    step: float

    @property
    def positions(self) -> Array:
        """(N, 3) of the nodes in the map."""
        return self.T_map_base[:, :3, 3]

    def pose(self, node_id: int) -> Pose | None:
        """T_map_base of a node; None when it has none."""
        row = self.rows.get(node_id)
        return None if row is None else self.T_map_base[row]


def scene_model(snapshot: Snapshot) -> SceneModel:
    """The arrays of a map."""
    table, poses = snapshot.nodes, snapshot.poses
    kept = [row for row, node_id in enumerate(table.ids.tolist()) if node_id in poses]
    ids = table.ids[kept]
    T_map_base = np.array([poses[i] for i in ids.tolist()]).reshape(-1, 4, 4)
    rows = {node_id: row for row, node_id in enumerate(ids.tolist())}
    links = tuple(link for link in snapshot.links.values() if link.from_id in rows and link.to_id in rows)
    refused = tuple(
        pair
        for pair, row in snapshot.candidates.items()
        if row.candidate.refusal is not None and pair not in snapshot.links and set(pair) <= rows.keys()
    )
    return SceneModel(
        ids=ids,
        T_map_base=T_map_base,
        T_odom_base=table.T_odom[kept],
        T_world_base=table.T_world[kept],
        map_ids=table.map_ids[kept],
        weights=table.weights[kept],
        stamps=table.stamps[kept],
        tiers=np.array([_TIERS.index(snapshot.tiers.get(i, Tier.LTM)) for i in ids.tolist()], dtype=np.int8),
        rows=rows,
        links=links,
        refused=refused,
        step=_step(T_map_base),
    )


def _step(T_map_base: Array) -> float:
    """Median distance between nodes that follow each other, within what looks right in a room and in a building."""
    steps = np.linalg.norm(np.diff(T_map_base[:, :3, 3], axis=0), axis=1)
    moving = steps[steps > 0.005]
    return float(np.clip(np.median(moving), 0.04, 0.6)) if len(moving) else 0.15
