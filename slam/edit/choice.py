"""Which links of a graph somebody means."""

from __future__ import annotations

from slam.edit.wishes import LinkChoice
from slam.errors import DecisionError
from slam.graph.graph import PoseGraph
from slam.types import Link, LinkType


def chosen(graph: PoseGraph, wanted: LinkChoice) -> list[Link]:
    """The links between two nodes that are meant, by their ids.

    Raises:
        DecisionError: the session does not exist.
    """
    require_session(graph, wanted.session)
    return [link for _, link in sorted(graph.links.items()) if _is_meant(link, graph, wanted)]


def sightings(graph: PoseGraph, wanted: LinkChoice) -> list[Link]:
    """The sightings of landmarks that are meant: of the nodes in the range, where their type is named."""
    found = [link for _, link in sorted(graph.constraints.items()) if link.type is LinkType.LANDMARK]
    return [link for link in found if LinkType.LANDMARK in wanted.types and _of_nodes(link, graph, wanted)]


def require_session(graph: PoseGraph, session: int) -> None:
    """Raises DecisionError for a session that no node of the graph is of; -1 stands for all."""
    known = sorted(set(graph.map_ids.values()))
    if session >= 0 and session not in known:
        raise DecisionError(f"no node is of session {session}: the map has {', '.join(map(str, known))}")


def _is_meant(link: Link, graph: PoseGraph, wanted: LinkChoice) -> bool:
    low, high = link.pair
    same = graph.map_ids[low] == graph.map_ids[high]
    of_type = not wanted.types or link.type in wanted.types
    return of_type and (wanted.intra if same else wanted.inter) and _of_nodes(link, graph, wanted)


def _of_nodes(link: Link, graph: PoseGraph, wanted: LinkChoice) -> bool:
    """Whether its nodes are in the range and, one at least, of the session."""
    ends = [i for i in link.pair if i > 0]
    in_range = ends[0] >= wanted.first and (not wanted.last or ends[-1] <= wanted.last)
    return in_range and (wanted.session < 0 or wanted.session in [graph.map_ids[i] for i in ends])
