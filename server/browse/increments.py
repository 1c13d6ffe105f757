"""What changed in a graph since the revision that somebody has."""

from __future__ import annotations

import threading

import numpy as np
from numpy.typing import NDArray

from server.browse.snapshot import Pair, Snapshot
from slam.types import Tier

_TIERS = {tier: code for code, tier in enumerate(Tier)}


class Increments:
    """Remembers for every node and link the revision in which it last changed.

    Whoever has a revision gets the nodes and links that changed after it; when one was removed meanwhile, everything.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._revision = 0
        self._full_since = 0
        self._rows: dict[int, bytes] = {}
        self._node_revisions: dict[int, int] = {}
        self._link_revisions: dict[Pair, int] = {}
        self._sigmas: dict[Pair, float] = {}

    def since(self, after: int, snapshot: Snapshot) -> tuple[set[int], set[Pair]] | None:
        """Ids and pairs that changed after revision ``after``; None when all must be sent."""
        with self._lock:
            if snapshot.revision > self._revision:
                self._take_in(snapshot)
            if not self._full_since <= after <= self._revision or after == 0:
                return None
            nodes = {node_id for node_id, revision in self._node_revisions.items() if revision > after}
            links = {pair for pair, revision in self._link_revisions.items() if revision > after}
            return nodes, links

    def _take_in(self, snapshot: Snapshot) -> None:
        revision = snapshot.revision
        rows = dict(zip(snapshot.nodes.ids.tolist(), _row_bytes(snapshot), strict=True))
        sigmas = {pair: round(snapshot.residuals.get(pair, -1.0), 3) for pair in snapshot.links}
        if self._rows.keys() - rows.keys() or self._sigmas.keys() - sigmas.keys():
            self._full_since = revision
        for node_id, row in rows.items():
            if self._rows.get(node_id) != row:
                self._node_revisions[node_id] = revision
        for pair, sigma in sigmas.items():
            if self._sigmas.get(pair) != sigma:
                self._link_revisions[pair] = revision
        self._node_revisions = {node_id: self._node_revisions[node_id] for node_id in rows}
        self._link_revisions = {pair: self._link_revisions[pair] for pair in sigmas}
        self._rows, self._sigmas, self._revision = rows, sigmas, revision


def _row_bytes(snapshot: Snapshot) -> list[bytes]:
    """All that the page gets of each node, in a form that compares fast."""
    table, poses = snapshot.nodes, snapshot.poses
    unknown: NDArray[np.float64] = np.full((4, 4), np.nan)
    positions = np.array([poses.get(i, unknown)[:3] for i in table.ids.tolist()]).reshape(len(table), 12)
    tiers = np.array([_TIERS[snapshot.tiers.get(i, Tier.LTM)] for i in table.ids.tolist()])
    columns = np.column_stack([positions.round(6), tiers, table.weights])
    return [row.tobytes() for row in np.ascontiguousarray(columns, dtype=np.float64)]
