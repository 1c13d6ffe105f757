"""What is said of a map as a whole."""

from __future__ import annotations

from collections import Counter

from server.browse.faults import row_faults
from server.browse.map_view import MapView
from server.browse.notes import notes
from server.browse.sessions import session_list
from server.catalog import MapFile
from server.schemas import MapFacts, MapInfo, MapSummary
from slam.database import MapInfo as StoredInfo
from slam.database import MapReader
from slam.errors import DatabaseError
from slam.tools.describe import path_size
from slam.types import LinkType, Tier

#: A file that another program holds does not keep the list of all waiting.
_PATIENCE_S = 0.1
_LOOPS = {kind.label for kind in LinkType if kind.is_loop}


def facts(info: StoredInfo) -> MapFacts:
    """What ``slamdeck info`` says."""
    return MapFacts(
        version=info.version,
        sessions=info.sessions,
        nodes=info.nodes,
        dropped=info.dropped,
        links=dict(info.links),
        words=info.words,
        features=info.features,
        size_bytes=info.size_bytes,
        bytes_by_kind=dict(info.bytes_by_kind),
        parameters=dict(info.parameters),
        seeds=list(info.seeds),
        sources=list(info.sources),
        clean=info.clean,
        has_poses=info.has_poses,
        first_stamp=info.first_stamp,
        last_stamp=info.last_stamp,
    )


def detail(view: MapView, *, live: bool, writable: bool) -> MapInfo:
    """One map in detail."""
    snapshot = view.snapshot()
    info = view.reader.info(sizes=False, faults=snapshot.faults)
    # What a map is made of: rows of it that make no sense are known now.
    ate_m, _ = snapshot.ate_m, (snapshot.nodes, snapshot.poses, snapshot.links, snapshot.candidates)
    faults = snapshot.faults | view.statistics.faults
    path = path_size(snapshot.nodes, snapshot.poses)
    return MapInfo(
        **facts(info).model_dump(),
        id=view.file.id,
        name=view.file.name,
        loops=loop_count(info),
        refused=sum(pair not in snapshot.links for pair in snapshot.candidates),
        live=live,
        writable=writable,
        has_truth=snapshot.truth.is_known,
        ate_m=ate_m,
        notes=notes(snapshot, clean=info.clean, live=live),
        has_scans=bool(snapshot.scanned),
        span_s=path.span_s,
        odometry_m=path.odometry_m,
        map_m=path.map_m,
        has_model=view.reader.has_cloud(),
        memory=Counter(snapshot.tiers.get(node_id, Tier.LTM).value for node_id in snapshot.rows),
        session_list=session_list(view.reader, snapshot.all_nodes, snapshot.all_links, snapshot.faults),
        faults=row_faults(faults),
        fault_count=len(faults),
    )


def summary(file: MapFile, *, live: bool) -> MapSummary:
    """A map in the list; one that can't be read says why."""
    try:
        state = file.path.stat()
    except OSError as error:
        return _unreadable(file, 0, 0.0, f"{file.name}: {error.strerror}")
    try:
        info = MapReader(file.path, _PATIENCE_S).info(sizes=False, faults={})
    except DatabaseError as error:
        return _unreadable(file, state.st_size, state.st_mtime, str(error))
    return MapSummary(
        id=file.id,
        name=file.name,
        size_bytes=info.size_bytes,
        modified=state.st_mtime,
        version=info.version,
        sessions=info.sessions,
        nodes=info.nodes,
        links=dict(info.links),
        loops=loop_count(info),
        live=live,
    )


def loop_count(info: StoredInfo) -> int:
    """Number of loop closures in the graph."""
    return sum(count for kind, count in info.links.items() if kind in _LOOPS)


def _unreadable(file: MapFile, size: int, modified: float, why: str) -> MapSummary:
    return MapSummary(
        id=file.id,
        name=file.name,
        size_bytes=size,
        modified=modified,
        version="",
        sessions=0,
        nodes=0,
        links={},
        loops=0,
        live=False,
        error=why,
    )
