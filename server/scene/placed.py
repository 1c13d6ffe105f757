"""The part of a map that has a place in the 3D view, as arrays."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from server.browse.snapshot import Pair, Snapshot
from server.browse.timeline import Moment
from slam.geometry import Pose
from slam.types import LinkType, Tier

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

_TIERS = {Tier.STM: 0, Tier.WM: 1, Tier.LTM: 2}


class LinkKind(Enum):
    """Links that are drawn alike; ``REFUSED`` are loops that were looked at and are no links, or no more."""

    NEIGHBOR = "neighbor"
    LOOP = "loop"
    PROXIMITY = "proximity"
    TIME = "time"
    USER = "user"
    VIRTUAL = "virtual"
    REFUSED = "refused"


_KINDS = {
    LinkType.NEIGHBOR: LinkKind.NEIGHBOR,
    LinkType.NEIGHBOR_MERGED: LinkKind.NEIGHBOR,
    LinkType.GLOBAL_CLOSURE: LinkKind.LOOP,
    LinkType.LOCAL_SPACE_CLOSURE: LinkKind.PROXIMITY,
    LinkType.LOCAL_TIME_CLOSURE: LinkKind.TIME,
    LinkType.USER_CLOSURE: LinkKind.USER,
    LinkType.VIRTUAL_CLOSURE: LinkKind.VIRTUAL,
}
#: Those that are no part of the path.
LOOPS = (LinkKind.LOOP, LinkKind.PROXIMITY, LinkKind.TIME, LinkKind.USER, LinkKind.REFUSED)

#: Of more refused loops than this only the newest are shown.
_MOST_REFUSED = 300


@dataclass(frozen=True, slots=True, eq=False)
class PlacedGraph:
    """Nodes whose pose is known, ascending by id, and the links between them.

    Attributes:
        ids: (N,) node ids.
        T_map: (N, 4, 4) poses T_map_base.
        T_odom: (N, 4, 4) odometry poses, NaN where unknown.
        T_world: (N, 4, 4) ground truth, NaN where unknown.
        map_ids: (N,) session numbers.
        weights: (N,) weights.
        tiers: (N,) 0, 1, 2 for short-term, working and long-term memory.
        links: (L, 2) rows of both nodes of each link, by kind.
        rows: row of each node id.
    """

    ids: Ints
    T_map: Array
    T_odom: Array
    T_world: Array
    map_ids: Ints
    weights: Ints
    tiers: Ints
    links: dict[LinkKind, Ints]
    rows: dict[int, int]

    def __len__(self) -> int:
        return len(self.ids)

    @property
    def positions(self) -> Array:
        """(N, 3) metres in the map frame."""
        return self.T_map[:, :3, 3]

    @classmethod
    def of(cls, snapshot: Snapshot) -> PlacedGraph:
        """The graph of a map as it is now; nodes without a finite pose are left out."""
        table, poses = snapshot.nodes, snapshot.poses
        every: list[int] = table.ids.tolist()
        kept = [row for row, node_id in enumerate(every) if node_id in poses and np.isfinite(poses[node_id]).all()]
        ids = [every[row] for row in kept]
        rows = {node_id: row for row, node_id in enumerate(ids)}
        return cls(
            ids=np.array(ids, dtype=np.int64),
            T_map=np.array([poses[node_id] for node_id in ids], dtype=np.float64).reshape(-1, 4, 4),
            T_odom=table.T_odom[kept],
            T_world=table.T_world[kept],
            map_ids=table.map_ids[kept].astype(np.int64),
            weights=table.weights[kept].astype(np.int64),
            tiers=np.array([_TIERS[snapshot.tiers.get(node_id, Tier.LTM)] for node_id in ids], dtype=np.int64),
            links=_links(snapshot, rows),
            rows=rows,
        )

    def without(self, pairs: Collection[Pair]) -> PlacedGraph:
        """The same without the links of these pairs (smaller id first)."""
        if not pairs:
            return self
        gone = set(pairs)
        kept = {
            kind: rows[[(min(ends), max(ends)) not in gone for ends in self.ids[rows].tolist()]]
            for kind, rows in self.links.items()
        }
        return replace(self, links=kept)

    def without_sessions(self, sessions: Collection[int]) -> PlacedGraph:
        """The same without the nodes of some sessions and their links."""
        kept = ~np.isin(self.map_ids, list(sessions))
        if kept.all():
            return self
        place = np.cumsum(kept) - 1
        ids = self.ids[kept]
        return PlacedGraph(
            ids=ids,
            T_map=self.T_map[kept],
            T_odom=self.T_odom[kept],
            T_world=self.T_world[kept],
            map_ids=self.map_ids[kept],
            weights=self.weights[kept],
            tiers=self.tiers[kept],
            links={kind: place[rows[kept[rows].all(axis=1)]] for kind, rows in self.links.items()},
            rows={node_id: row for row, node_id in enumerate(ids.tolist())},
        )

    def then(self, moment: Moment, poses: Mapping[int, Pose] | None = None) -> PlacedGraph:
        """What of it was there at a moment, with the tiers and loops of then, at the poses of then or else of now."""
        count = int(np.searchsorted(self.ids, moment.at, side="right"))
        rows = {node_id: row for node_id, row in self.rows.items() if row < count}
        links = {kind: pairs[(pairs < count).all(axis=1)] for kind, pairs in self.links.items()}
        return replace(
            self,
            ids=self.ids[:count],
            T_map=self.T_map[:count] if poses is None else self._moved(count, poses),
            T_odom=self.T_odom[:count],
            T_world=self.T_world[:count],
            map_ids=self.map_ids[:count],
            weights=self.weights[:count],
            tiers=np.array([_TIERS[moment.tiers.get(node_id, Tier.LTM)] for node_id in rows], dtype=np.int64),
            links=links | _loops_then(moment, rows),
            rows=rows,
        )

    def _moved(self, count: int, poses: Mapping[int, Pose]) -> Array:
        """The first poses (count, 4, 4), where others are known those."""
        T_map = self.T_map[:count].copy()
        for row, node_id in enumerate(self.ids[:count].tolist()):
            if node_id in poses:
                T_map[row] = poses[node_id]
        return T_map

    def pair_of(self, kind: LinkKind, index: int) -> Pair:
        """Ids of both nodes of a link."""
        a, b = self.links[kind][index]
        return int(self.ids[a]), int(self.ids[b])


def _links(snapshot: Snapshot, rows: dict[int, int]) -> dict[LinkKind, Ints]:
    """Rows of both ends by kind, sorted, so that a map that grows changes only the end of each list."""
    found: dict[LinkKind, list[Pair]] = {kind: [] for kind in LinkKind}
    for link in snapshot.links.values():
        kind = _KINDS.get(link.type)
        if kind is not None and link.from_id in rows and link.to_id in rows:
            found[kind].append((rows[link.from_id], rows[link.to_id]))
    found[LinkKind.REFUSED] = _refused(snapshot, rows)
    return _ordered(found)


def _loops_then(moment: Moment, rows: dict[int, int]) -> dict[LinkKind, Ints]:
    found: dict[LinkKind, list[Pair]] = {kind: [] for kind in LOOPS}
    for pair, type_ in moment.loops.items():
        found[_KINDS[type_]].append((pair[1], pair[0]))
    placed = {kind: [(rows[b], rows[a]) for b, a in pairs if a in rows and b in rows] for kind, pairs in found.items()}
    refused = [(rows[a], rows[b]) for a, b in moment.refused if a in rows and b in rows]
    placed[LinkKind.REFUSED] = sorted(refused, key=max)[-_MOST_REFUSED:]
    return _ordered(placed)


def _ordered(found: dict[LinkKind, list[Pair]]) -> dict[LinkKind, Ints]:
    arrays = {kind: np.array(pairs, dtype=np.int64).reshape(-1, 2) for kind, pairs in found.items()}
    return {kind: pairs[np.lexsort((pairs.min(axis=1), pairs.max(axis=1)))] for kind, pairs in arrays.items()}


def _refused(snapshot: Snapshot, rows: dict[int, int]) -> list[Pair]:
    looked_at = [row.candidate for pair, row in snapshot.candidates.items() if pair not in snapshot.links]
    pairs = [(rows[c.from_id], rows[c.to_id]) for c in looked_at if c.from_id in rows and c.to_id in rows]
    return sorted(pairs, key=max)[-_MOST_REFUSED:]
