"""A copy of a map with fewer nodes, in which everything that is kept is equal to the original."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slam.database import MapReader, MapWriter, NodeTable
from slam.database.thinning import copy_without
from slam.errors import DatabaseError
from slam.geometry import between
from slam.graph.graph import PoseGraph
from slam.maps.grid_rebuild import GridRebuild
from slam.tools.gap import covariance
from slam.tools.output import new_map
from slam.tools.parameters import taken
from slam.types import WEIGHT_INTERMEDIATE, WEIGHT_INVALID, Link, LinkType

#: Stamps of a camera jitter by less than this share of the time between two nodes.
_JITTER = 0.05


@dataclass(frozen=True, slots=True)
class Thinning:
    """What is kept.

    Attributes:
        sessions: their numbers; none for all.
        rate: at most so many nodes a second, None for all.
        start: seconds after the first node, None from the beginning.
        end: seconds after the first node, None to the end.
        images: whether colour and depth images are kept.
    """

    sessions: Sequence[int] = ()
    rate: float | None = None
    start: float | None = None
    end: float | None = None
    images: bool = True


@dataclass(frozen=True, slots=True)
class Thinned:
    """Nodes kept, of how many, and the number of new links of odometry over gaps."""

    nodes: int
    of: int
    bridges: int


def thin(source: Path, target: Path, wanted: Thinning, *, force: bool = False) -> Thinned:
    """Make the copy. Nodes that people touched (links by hand, decisions, labels) are not thinned out by the rate.

    Neighbours in time that lose the nodes between them are joined by odometry's own motion, with the covariances added.

    Raises:
        DatabaseError: the file can't be read, has no such session, or no node would be left.
    """
    reader = MapReader(source)
    table = reader.nodes()
    kept = _kept(reader, table, wanted)
    dropped = sorted(set(table.ids.tolist()) - kept)
    # Dropped nodes of the original stay where nothing is thinned: they are part of an equal copy.
    bridges = _bridges(reader, table, kept) if dropped else []
    with new_map(target, [source], force=force) as part:
        copy_without(source, part, dropped, bridges, images=wanted.images)
        if dropped:
            _follow(part, set(dropped))
    whole = table.weights > WEIGHT_INVALID
    return Thinned(sum(i in kept for i in table.ids[whole].tolist()), int(whole.sum()), len(bridges))


def _kept(reader: MapReader, table: NodeTable, wanted: Thinning) -> set[int]:
    unknown = set(wanted.sessions) - set(table.map_ids.tolist())
    if unknown:
        raise DatabaseError(f"{reader.path}: there is no session {min(unknown)}; it has {_numbers(table)}")
    first = float(table.stamps.min(initial=np.inf))
    inside = np.ones(len(table), bool) if not wanted.sessions else np.isin(table.map_ids, list(wanted.sessions))
    inside &= table.stamps >= first + (wanted.start or 0.0)
    inside &= True if wanted.end is None else table.stamps <= first + wanted.end
    chosen = set(table.ids[inside].tolist())
    if wanted.rate is not None:
        if wanted.rate <= 0:
            raise DatabaseError(f"--rate {wanted.rate:g} keeps nothing: name a number of nodes a second above 0")
        chosen &= _at_rate(table, chosen, wanted.rate) | _touched(reader, table)
    if not chosen:
        raise DatabaseError(f"{reader.path}: no node is in these sessions and seconds: none would be left")
    return chosen


def _at_rate(table: NodeTable, chosen: set[int], rate: float) -> set[int]:
    found: set[int] = set()
    last: dict[int, float] = {}
    rows = zip(table.ids.tolist(), table.map_ids.tolist(), table.stamps.tolist(), table.weights.tolist(), strict=True)
    for node_id, map_id, stamp, weight in rows:
        if node_id not in chosen or weight <= WEIGHT_INTERMEDIATE:
            continue
        if map_id not in last or not 0.0 <= stamp - last[map_id] < (1.0 - _JITTER) / rate:
            found.add(node_id)
            last[map_id] = stamp
    return found


def _touched(reader: MapReader, table: NodeTable) -> set[int]:
    """Ends of links by hand and of decisions, and nodes with a label."""
    found = {i for link in reader.links() if link.type is LinkType.USER_CLOSURE for i in link.pair}
    found |= {i for entry in reader.journal() for i in entry.pair}
    return found | {i for i, label in zip(table.ids.tolist(), table.labels, strict=True) if label}


def _bridges(reader: MapReader, table: NodeTable, kept: set[int]) -> list[Link]:
    """Links between kept nodes of a session that follow each other, where odometry led over dropped ones."""
    graph = PoseGraph.from_reader(reader)
    map_id_of = dict(zip(table.ids.tolist(), table.map_ids.tolist(), strict=True))
    found = []
    for node_id in sorted(kept & graph.T_odom.keys()):
        at, total = _before(graph, node_id), np.zeros((6, 6))
        step = graph.links.get((at, node_id)) if at else None
        while step is not None:
            total = total + covariance(step)
            if at in kept:
                break
            older = _before(graph, at)
            step, at = (graph.links.get((older, at)) if older else None), older
        gap = at in kept and step is not None and (at, node_id) not in graph.links
        if gap and map_id_of[at] == map_id_of[node_id]:
            T = between(graph.T_odom[node_id], graph.T_odom[at])
            found.append(Link(node_id, at, LinkType.NEIGHBOR, T, np.asarray(np.linalg.inv(total), np.float64)))
    return found


def _before(graph: PoseGraph, node_id: int) -> int:
    """The older end of a node's link of odometry, 0 where it has none."""
    older = [i for i, link in graph.neighbors(node_id).items() if i < node_id and link.type is LinkType.NEIGHBOR]
    return max(older, default=0)


def _follow(part: Path, dropped: set[int]) -> None:
    """The poses of the nodes that stay are left as they were; the grid is made anew of theirs."""
    with MapWriter.open(part) as writer:
        reader = MapReader(part)
        poses = {node_id: T for node_id, T in reader.poses().items() if node_id not in dropped}
        if poses:
            writer.save_poses(poses, None)
        GridRebuild(reader, writer, PoseGraph.from_reader(reader), taken(reader).params).carry_out()


def _numbers(table: NodeTable) -> str:
    return ", ".join(map(str, sorted(set(table.map_ids.tolist()))))
