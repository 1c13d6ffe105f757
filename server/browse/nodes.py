"""Nodes in a table, and one in full."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from server.browse.columns import number_list, pose_list
from server.browse.faults import row_faults
from server.browse.journal import journal_entry
from server.browse.link_noise import link_sigmas
from server.browse.map_view import MapView
from server.browse.search import matching
from server.browse.sensors import node_sensors
from server.browse.snapshot import Snapshot
from server.browse.statistics import values_at
from server.errors import NotFoundError
from server.schemas import CameraModel, NodeDetail, NodeFeatures, NodeLink, NodePage, NodeRow, PixelDepth
from slam.camera import Camera
from slam.database import Fault, Faults, JournalEntry, NodeTable
from slam.errors import DamagedRowError, DatabaseError
from slam.geometry import inverse, transform, translation_norm
from slam.types import Link, Tier

#: How many key points became words: counting the rows of the file for each node of a table would take far longer.
NodeOrder = Literal["id", "-id", "weight", "-weight", "stamp", "-stamp"]


def page(
    view: MapView,
    *,
    offset: int,
    limit: int,
    order: NodeOrder,
    query: str,
    dropped: bool = False,
    find: int | None = None,
) -> NodePage:
    """Some rows of the node table: those that fit the query, in an order, and the row of the node to ``find``.

    With ``dropped`` merged and dropped nodes (weight -9) are among them, which are no part of the map.

    Raises:
        QueryError: the query is not understood.
    """
    snapshot = view.snapshot()
    table = snapshot.all_nodes if dropped else snapshot.nodes
    keys: dict[str, NDArray[np.generic]] = {"id": table.ids, "weight": table.weights, "stamp": table.stamps}
    rows = np.argsort(keys[order.removeprefix("-")], kind="stable")
    if order.startswith("-"):
        rows = rows[::-1]
    if query.strip():
        rows = rows[matching(snapshot, table, query)[rows]]
    shown = rows[offset : offset + limit].tolist()
    words = _words(view, table.ids[shown].tolist())
    at = np.flatnonzero(table.ids[rows] == find)
    return NodePage(
        total=len(rows), at=int(at[0]) if len(at) else None, nodes=[_row(snapshot, table, row, words) for row in shown]
    )


def detail(view: MapView, node_id: int) -> NodeDetail:
    """One node in full, also a dropped one; raises NotFoundError when the file has none of this id."""
    snapshot = view.snapshot()
    table = snapshot.all_nodes
    row = require_known(snapshot, node_id)
    node = view.reader.node(node_id)
    true = None if node.T_world_base is None else snapshot.truth.T_map_world @ node.T_world_base
    linked = sorted(snapshot.links_at.get(node_id, []), key=lambda link: (link.type, link.pair))
    faults: Faults = {}
    measured, sensors = values_at(view.reader, node_id, faults), node_sensors(view.reader, node_id)
    cameras = _cameras(view, node_id, faults)
    faults |= dict.fromkeys(fault for fault in snapshot.faults if _is_about(fault, node_id))
    right = any(camera.baseline_m is not None for camera in cameras)
    return NodeDetail(
        **_row(snapshot, table, row, {node_id: node.words}).model_dump(),
        pose=pose_list(snapshot.poses.get(node_id)),
        odom=pose_list(node.T_odom_base),
        truth=pose_list(true),
        camera=cameras[0] if cameras else None,
        cameras=cameras,
        sensors=sensors,
        features=node.features,
        session_index=int((table.map_ids[: row + 1] == table.map_ids[row]).sum()),
        session_nodes=int((table.map_ids == table.map_ids[row]).sum()),
        image_bytes=node.image_bytes,
        depth_bytes=node.depth_bytes,
        links=[node_link(link) for link in linked],
        statistics=measured,
        has_image=node.image_bytes > 0,
        has_depth=node.depth_bytes > 0 and not right,
        has_right=node.depth_bytes > 0 and right,
        has_confidence=view.reader.has_confidence(node_id),
        decisions=[journal_entry(entry) for entry in snapshot.journal if _decides_about(entry, node_id)],
        faults=row_faults(faults),
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
        depth_m=number_list(_depths(view, node_id, found.points_base, found.pixels[:, 0]), 4),
    )


def require_node(snapshot: Snapshot, node_id: int) -> None:
    """Raises NotFoundError when the map has no such node."""
    if node_id not in snapshot.rows:
        ids = snapshot.nodes.ids
        range_ = f"its nodes are {ids[0]} to {ids[-1]}" if len(ids) else "it has none"
        raise NotFoundError(f"the map has no node {node_id}: {range_}")


def require_known(snapshot: Snapshot, node_id: int) -> int:
    """Its row in ``all_nodes``; raises NotFoundError when the file has no such node, not even a dropped one."""
    ids = snapshot.all_nodes.ids
    row = int(np.searchsorted(ids, node_id))
    if row == len(ids) or ids[row] != node_id:
        require_node(snapshot, node_id)
    return row


def pixel(view: MapView, node_id: int, x: float, y: float) -> PixelDepth:
    """What is at a place of a node's image; x and y from 0 to 1 across the whole of it."""
    snapshot = view.snapshot()
    require_known(snapshot, node_id)
    return view.pixels.at(node_id, x, y, snapshot.poses.get(node_id), snapshot.revision)


def camera_of(view: MapView, node_id: int) -> Camera | None:
    """Camera of a node; None where the file has no calibration for it; DatabaseError where that is damaged."""
    if not view.reader.node(node_id).calibration_bytes:
        return None
    return view.reader.camera(node_id)


def _words(view: MapView, node_ids: Sequence[int]) -> dict[int, int]:
    """Id -> number of key points that are words, of some nodes: counted, as RTAB-Map's statistic counts others too."""
    return {**dict.fromkeys(node_ids, 0), **view.reader.word_counts(node_ids)}


def _row(snapshot: Snapshot, table: NodeTable, row: int, words: Mapping[int, int]) -> NodeRow:
    node_id = int(table.ids[row])
    return NodeRow(
        id=node_id,
        map_id=int(table.map_ids[row]),
        weight=int(table.weights[row]),
        stamp=float(table.stamps[row]),
        label=table.labels[row] or "",
        tier=snapshot.tiers.get(node_id, Tier.LTM),
        words=words[node_id],
        loops=snapshot.loop_counts[node_id],
    )


def node_link(link: Link) -> NodeLink:
    """A link as one of its nodes lists it."""
    T_from_to = link.T_from_to
    sigmas = None if T_from_to is None else link_sigmas(link.information)
    return NodeLink(
        from_=link.from_id,
        to=link.to_id,
        type=link.type.label,
        translation_m=None if T_from_to is None else translation_norm(T_from_to),
        transform=pose_list(T_from_to),
        sigma_m=None if sigmas is None else float(sigmas[:3].max()),
        sigma_deg=None if sigmas is None else float(np.degrees(sigmas[3:].max())),
    )


def _cameras(view: MapView, node_id: int, faults: Faults) -> list[CameraModel]:
    """Its cameras; none, and a fault, where the calibration makes no sense."""
    if node_id not in view.snapshot().calibrated:
        return []
    try:
        cameras, baselines = view.reader.cameras(node_id), view.reader.baselines(node_id)
    except DatabaseError as error:
        faults[Fault("Data", str(node_id), error.reason if isinstance(error, DamagedRowError) else str(error))] = None
        return []
    pairs = zip(cameras, baselines or [None] * len(cameras), strict=True)
    return [
        CameraModel(
            width=c.width,
            height=c.height,
            fx=c.fx,
            fy=c.fy,
            cx=c.cx,
            cy=c.cy,
            mount=pose_list(c.T_base_cam),
            baseline_m=baseline,
        )
        for c, baseline in pairs
    ]


def _is_about(fault: Fault, node_id: int) -> bool:
    return fault.table in ("Node", "Link", "Data") and str(node_id) in fault.row.split("-")


def _depths(
    view: MapView, node_id: int, points_base: NDArray[np.float32], columns: NDArray[np.float32]
) -> NDArray[np.float64]:
    """Depth (N,) of points along the axis of the camera whose tile of the image they are in; NaN without a camera."""
    depths = np.full(len(points_base), np.nan)
    if node_id not in view.snapshot().calibrated:
        return depths
    try:
        cameras = view.reader.cameras(node_id)
    except DatabaseError:
        # The node itself says so; its key points are still there.
        return depths
    tiles = np.clip(columns // max(1, cameras[0].width), 0, len(cameras) - 1).astype(int)
    for tile, camera in enumerate(cameras):
        here = tiles == tile
        depths[here] = transform(inverse(camera.T_base_cam), points_base[here])[:, 2]
    return depths


def _decides_about(entry: JournalEntry, node_id: int) -> bool:
    return node_id in entry.pair and entry.placement is None
