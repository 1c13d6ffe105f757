"""Nodes in a table, and one in full."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from server.browse.columns import number_list, pose_list
from server.browse.journal import journal_entry
from server.browse.map_view import MapView
from server.browse.snapshot import Snapshot
from server.errors import NotFoundError
from server.schemas import CameraModel, NodeDetail, NodeFeatures, NodeLink, NodePage, NodeRow
from slam.camera import Camera
from slam.geometry import inverse, transform, translation_norm
from slam.types import Link, Tier

#: How many key points became words: counting the rows of the file for each node of a table would take far longer.
_WORDS = "Keypoint/Current_frame/words"
NodeOrder = Literal["id", "-id", "weight", "-weight", "stamp", "-stamp"]


def page(view: MapView, *, offset: int, limit: int, order: NodeOrder, query: str) -> NodePage:
    """Some rows of the node table: those whose id or label holds the text, in an order."""
    snapshot = view.snapshot()
    table = snapshot.nodes
    keys: dict[str, NDArray[np.generic]] = {"id": table.ids, "weight": table.weights, "stamp": table.stamps}
    rows = np.argsort(keys[order.removeprefix("-")], kind="stable")
    if order.startswith("-"):
        rows = rows[::-1]
    wanted = query.strip().lower()
    if wanted:
        rows = np.array([row for row in rows if wanted in f"{table.ids[row]} {table.labels[row] or ''}".lower()], int)
    shown = rows[offset : offset + limit].tolist()
    return NodePage(total=len(rows), nodes=[_row(view, snapshot, row) for row in shown])


def detail(view: MapView, node_id: int) -> NodeDetail:
    """One node in full; raises NotFoundError when the map has none of this id."""
    snapshot = view.snapshot()
    require_node(snapshot, node_id)
    node = view.reader.node(node_id)
    true = None if node.T_world_base is None else snapshot.T_map_world @ node.T_world_base
    linked = [link for link in snapshot.links.values() if node_id in (link.from_id, link.to_id)]
    return NodeDetail(
        **_row(view, snapshot, snapshot.rows[node_id]).model_dump(),
        pose=pose_list(snapshot.poses.get(node_id)),
        odom=pose_list(node.T_odom_base),
        truth=pose_list(true),
        camera=_camera(view, node_id),
        features=node.features,
        links=[_link(link) for link in sorted(linked, key=lambda link: (link.type, link.pair))],
        statistics=view.statistics.at(node_id),
        has_image=node.image_bytes > 0,
        has_depth=node.depth_bytes > 0,
        decisions=[journal_entry(entry) for entry in snapshot.journal if node_id in entry.pair],
    )


def features(view: MapView, node_id: int) -> NodeFeatures:
    """Key points of a node, with the depth of each along the optical axis."""
    require_node(view.snapshot(), node_id)
    found, words = view.reader.features(node_id)
    return NodeFeatures(
        x=found.pixels[:, 0].round(2).tolist(),
        y=found.pixels[:, 1].round(2).tolist(),
        size=found.sizes.round(2).tolist(),
        angle=found.angles.round(1).tolist(),
        word=words.tolist(),
        depth_m=number_list(_depths(view, node_id, found.points_base), 4),
    )


def require_node(snapshot: Snapshot, node_id: int) -> None:
    """Raises NotFoundError when the map has no such node."""
    if node_id not in snapshot.rows:
        ids = snapshot.nodes.ids
        range_ = f"its nodes are {ids[0]} to {ids[-1]}" if len(ids) else "it has none"
        raise NotFoundError(f"the map has no node {node_id}: {range_}")


def camera_of(view: MapView, node_id: int) -> Camera | None:
    """Camera of a node; None where the file has no calibration for it."""
    if node_id not in view.snapshot().calibrated:
        return None
    return view.reader.camera(node_id)


def _row(view: MapView, snapshot: Snapshot, row: int) -> NodeRow:
    table = snapshot.nodes
    node_id = int(table.ids[row])
    words = view.statistics.at(node_id).get(_WORDS)
    return NodeRow(
        id=node_id,
        map_id=int(table.map_ids[row]),
        weight=int(table.weights[row]),
        stamp=float(table.stamps[row]),
        label=table.labels[row] or "",
        tier=snapshot.tiers.get(node_id, Tier.LTM),
        words=view.reader.node(node_id).words if words is None else int(words),
        loops=snapshot.loop_counts[node_id],
    )


def _link(link: Link) -> NodeLink:
    length = None if link.T_from_to is None else translation_norm(link.T_from_to)
    return NodeLink(from_=link.from_id, to=link.to_id, type=link.type.label, translation_m=length)


def _camera(view: MapView, node_id: int) -> CameraModel | None:
    camera = camera_of(view, node_id)
    if camera is None:
        return None
    return CameraModel(width=camera.width, height=camera.height, fx=camera.fx, fy=camera.fy, cx=camera.cx, cy=camera.cy)


def _depths(view: MapView, node_id: int, points_base: NDArray[np.float32]) -> NDArray[np.float64]:
    camera = camera_of(view, node_id)
    if camera is None:
        return np.full(len(points_base), np.nan)
    return transform(inverse(camera.T_base_cam), points_base)[:, 2]
