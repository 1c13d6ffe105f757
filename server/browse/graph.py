"""The graph as columns."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from server.browse.columns import number_list, pose_list, pose_lists
from server.browse.map_view import MapView
from server.browse.snapshot import Pair, Snapshot
from server.schemas import Graph, LinkColumns, NodeColumns
from slam.geometry import Pose, inverse
from slam.types import Tier

_UNKNOWN = np.full((4, 4), np.nan)


def graph(view: MapView, after: int) -> Graph:
    """Nodes and links that changed after a revision; all of them where that can't be told."""
    snapshot = view.snapshot()
    changed = view.increments.since(after, snapshot)
    nodes, links = changed if changed is not None else (set(snapshot.rows), set(snapshot.links))
    return Graph(
        revision=snapshot.revision,
        full=changed is None,
        nodes=_nodes(snapshot, nodes),
        links=_links(snapshot, links),
        correction=pose_list(_correction(snapshot)),
        ate_m=snapshot.ate_m,
    )


def _nodes(snapshot: Snapshot, ids: Collection[int]) -> NodeColumns:
    rows = sorted(snapshot.rows[node_id] for node_id in ids)
    table = snapshot.nodes
    chosen: list[int] = table.ids[rows].tolist()
    return NodeColumns(
        id=chosen,
        map_id=table.map_ids[rows].tolist(),
        weight=table.weights[rows].tolist(),
        stamp=table.stamps[rows].tolist(),
        tier=[snapshot.tiers.get(node_id, Tier.LTM) for node_id in chosen],
        pose=pose_lists(np.array([snapshot.poses.get(i, _UNKNOWN) for i in chosen]).reshape(-1, 4, 4)),
        odom=pose_lists(table.T_odom[rows]),
        truth=pose_lists(table.T_world[rows]) if snapshot.truth.is_known else None,
    )


def _links(snapshot: Snapshot, pairs: Collection[Pair]) -> LinkColumns:
    links = [snapshot.links[pair] for pair in sorted(pairs)]
    sigmas = np.array([snapshot.residuals.get(link.pair, np.nan) for link in links])
    return LinkColumns(
        from_=[link.from_id for link in links],
        to=[link.to_id for link in links],
        type=[link.type.label for link in links],
        residual_sigma=number_list(sigmas, 3),
    )


def _correction(snapshot: Snapshot) -> Pose | None:
    if not len(snapshot.nodes):
        return None
    newest, T_odom_base = int(snapshot.nodes.ids[-1]), snapshot.nodes.T_odom[-1]
    if newest not in snapshot.poses or not np.isfinite(T_odom_base).all():
        return None
    return np.asarray(snapshot.poses[newest] @ inverse(T_odom_base))
