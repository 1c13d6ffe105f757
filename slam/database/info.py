"""The summary of a map file."""

from __future__ import annotations

from collections import Counter
from functools import reduce
from operator import add
from pathlib import Path

from sqlalchemy import Column, ColumnElement, Connection, Table, func, literal_column, select, text

from slam.database.admin_rows import read_version
from slam.database.faults import Faults, each_sound
from slam.database.file_check import size_with_log
from slam.database.parameter_rows import read_parameters
from slam.database.parameter_text import differing
from slam.database.pose_rows import has_changed
from slam.database.rows import MapInfo
from slam.database.session_rows import read_sessions
from slam.database.tables import admin, data, feature, info, link, node, statistics, word
from slam.types import WEIGHT_INVALID, LinkType

#: Stamps beyond are none.
_MOST_SECONDS = 1e300
_KINDS: dict[str, tuple[Column[bytes], ...]] = {
    "image": (data.c.image,),
    "depth": (data.c.depth,),
    "calibration": (data.c.calibration,),
    "scan": (data.c.scan, data.c.scan_info),
    "grid": (data.c.ground_cells, data.c.obstacle_cells, data.c.empty_cells),
    "user_data": (data.c.user_data,),
    "word": (word.c.descriptor,),
    "link": (link.c.information_matrix, link.c.transform, link.c.user_data),
    "statistics": (statistics.c.data, statistics.c.wm_state),
    "map": (admin.c.opt_poses, admin.c.opt_map, admin.c.opt_cloud, admin.c.opt_polygons, admin.c.opt_tex_materials),
}


def read_info(connection: Connection, path: Path, *, deck: bool, sizes: bool, faults: Faults | None = None) -> MapInfo:
    """Summary of a map; ``sizes`` asks for the bytes of each kind. Rows that make no sense go to ``faults``."""
    sessions = read_sessions(connection, deck=deck, faults=faults)
    stored = list(each_sound("Info", [("newest",)], lambda _: read_parameters(connection), faults))
    kept = node.c.weight > WEIGHT_INVALID
    nodes = connection.scalar(select(func.count()).select_from(node).where(kept)) or 0
    total = connection.scalar(select(func.count()).select_from(node)) or 0
    timed = kept & node.c.stamp.between(-_MOST_SECONDS, _MOST_SECONDS)
    first, last = connection.execute(select(func.min(node.c.stamp), func.max(node.c.stamp)).where(timed)).one()
    return MapInfo(
        path=path,
        version=read_version(connection),
        sessions=len(sessions),
        nodes=nodes,
        dropped=total - nodes,
        links=_links(connection),
        words=_count(connection, word),
        features=_count(connection, feature),
        size_bytes=size_with_log(path),
        bytes_by_kind=_bytes_by_kind(connection) if sizes else {},
        parameters=differing(stored[0] if stored else {}),
        seeds=tuple(s.seed for s in sessions if s.seed is not None),
        sources=tuple(s.source for s in sessions if s.source),
        clean=sessions[-1].clean if sessions and sessions[-1].started is not None else _was_closed(connection, total),
        has_poses=bool(connection.scalar(select(admin.c.opt_poses.is_not(None)))) or has_changed(connection),
        first_stamp=first,
        last_stamp=last,
    )


def _bytes_by_kind(connection: Connection) -> dict[str, int]:
    found = {"feature": _feature_bytes(connection)}
    for table in (data, word, link, statistics, admin):
        kinds = {kind: columns for kind, columns in _KINDS.items() if columns[0].table is table}
        # One walk over the table for all its kinds: each row of Data has pages of its own.
        lengths = [reduce(add, (_total_length(c) for c in columns)) for columns in kinds.values()]
        found |= dict(zip(kinds, map(int, connection.execute(select(*lengths)).one()), strict=True))
    return {kind: found[kind] for kind in (*_KINDS, "feature")}


def _total_length(column: Column[bytes]) -> ColumnElement[int]:
    return func.coalesce(func.sum(func.length(column)), 0)


def _links(connection: Connection) -> dict[str, int]:
    smaller, larger = func.min(link.c.from_id, link.c.to_id), func.max(link.c.from_id, link.c.to_id)
    pairs = select(link.c.type, smaller, larger).where(func.typeof(link.c.type) == "integer").distinct()
    kinds = Counter(row.type for row in connection.execute(pairs))
    names = {int(kind): kind.label for kind in LinkType}
    return {names.get(kind, f"Type{kind}"): count for kind, count in sorted(kinds.items())}


def _count(connection: Connection, table: Table) -> int:
    return connection.scalar(select(func.count()).select_from(table)) or 0


def _feature_bytes(connection: Connection) -> int:
    """Descriptors of one node are all of one length: its first row and the index tell, the others needn't be read."""
    first: ColumnElement[int] = func.min(literal_column("rowid"))
    nodes = (
        select(first.label("first"), func.count().label("rows"))
        .select_from(feature)
        .group_by(feature.c.node_id)
        .subquery()
    )
    length = func.coalesce(func.length(feature.c.descriptor), 0)
    total = select(func.sum(nodes.c.rows * length)).join_from(nodes, feature, text("Feature.rowid = first"))
    return int(connection.scalar(total) or 0)


def _was_closed(connection: Connection, nodes: int) -> bool:
    # RTAB-Map adds a row of zeros when it begins a file, and one that knows the last node when it closes it.
    last = select(info.c.last_sign_added).order_by(info.c.time_enter.desc(), info.c.last_sign_added.desc()).limit(1)
    return nodes == 0 or bool(connection.scalar(last))
