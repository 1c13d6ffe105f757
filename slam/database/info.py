"""The summary of a map file."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from sqlalchemy import Column, Connection, func, select

from slam.database.admin_rows import read_version
from slam.database.parameter_rows import read_parameters
from slam.database.parameter_text import differing
from slam.database.pose_rows import has_changed
from slam.database.rows import MapInfo
from slam.database.session_rows import read_sessions
from slam.database.tables import admin, data, feature, info, link, node, statistics, word
from slam.types import WEIGHT_INVALID, LinkType

_KINDS: dict[str, tuple[Column[bytes], ...]] = {
    "image": (data.c.image,),
    "depth": (data.c.depth,),
    "calibration": (data.c.calibration,),
    "scan": (data.c.scan, data.c.scan_info),
    "grid": (data.c.ground_cells, data.c.obstacle_cells, data.c.empty_cells),
    "user_data": (data.c.user_data,),
    "feature": (feature.c.descriptor,),
    "word": (word.c.descriptor,),
    "link": (link.c.information_matrix, link.c.transform, link.c.user_data),
    "statistics": (statistics.c.data, statistics.c.wm_state),
    "map": (admin.c.opt_poses, admin.c.opt_map, admin.c.opt_cloud, admin.c.opt_polygons, admin.c.opt_tex_materials),
}


def read_info(connection: Connection, path: Path, *, deck: bool, sizes: bool) -> MapInfo:
    """Summary of a map; ``sizes`` asks for the bytes of each kind, which reads all key points."""
    sessions = read_sessions(connection, deck=deck)
    kept = node.c.weight > WEIGHT_INVALID
    nodes = connection.scalar(select(func.count()).select_from(node).where(kept)) or 0
    total = connection.scalar(select(func.count()).select_from(node)) or 0
    first, last = connection.execute(select(func.min(node.c.stamp), func.max(node.c.stamp)).where(kept)).one()
    return MapInfo(
        path=path,
        version=read_version(connection),
        sessions=len(sessions),
        nodes=nodes,
        dropped=total - nodes,
        links=_links(connection),
        words=_count(connection, word.c.id),
        features=_count(connection, feature.c.node_id),
        size_bytes=sum(part.stat().st_size for part in (path, path.with_name(path.name + "-wal")) if part.exists()),
        bytes_by_kind={kind: _bytes(connection, columns) for kind, columns in _KINDS.items()} if sizes else {},
        parameters=differing(read_parameters(connection)),
        seeds=tuple(s.seed for s in sessions if s.seed is not None),
        sources=tuple(s.source for s in sessions if s.source),
        clean=sessions[-1].clean if sessions and sessions[-1].started is not None else _was_closed(connection, total),
        has_poses=bool(connection.scalar(select(admin.c.opt_poses.is_not(None)))) or has_changed(connection),
        first_stamp=first,
        last_stamp=last,
    )


def _links(connection: Connection) -> dict[str, int]:
    smaller, larger = func.min(link.c.from_id, link.c.to_id), func.max(link.c.from_id, link.c.to_id)
    pairs = select(link.c.type, smaller, larger).distinct()
    kinds = Counter(row.type for row in connection.execute(pairs))
    names = {int(kind): kind.label for kind in LinkType}
    return {names.get(kind, f"Type{kind}"): count for kind, count in sorted(kinds.items())}


def _count(connection: Connection, column: Column[int]) -> int:
    return connection.scalar(select(func.count(column))) or 0


def _bytes(connection: Connection, columns: tuple[Column[bytes], ...]) -> int:
    lengths = (func.coalesce(func.sum(func.length(column)), 0) for column in columns)
    return int(sum(connection.execute(select(*lengths)).one()))


def _was_closed(connection: Connection, nodes: int) -> bool:
    # RTAB-Map adds a row of zeros when it begins a file, and one that knows the last node when it closes it.
    last = select(info.c.last_sign_added).order_by(info.c.time_enter.desc(), info.c.last_sign_added.desc()).limit(1)
    return nodes == 0 or bool(connection.scalar(last))
