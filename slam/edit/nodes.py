"""Nodes that leave the map, with odometry's way bridged over the gap; labels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

from slam.database import JournalEntry, MapReader, NodeChange
from slam.errors import DecisionError
from slam.graph.composition import composed
from slam.graph.graph import Pair, PoseGraph
from slam.types import WEIGHT_INVALID, Link, LinkType

_STEPS = (LinkType.NEIGHBOR, LinkType.NEIGHBOR_MERGED)
_LONGEST_LABEL = 200


def dropping(graph: PoseGraph, reader: MapReader, node_ids: Sequence[int], author: str) -> list[JournalEntry]:
    """Entries that take nodes out of the map; their rows and images stay in the file, so that undo brings them back.

    All their links go; over the gap the nodes that odometry led to and from are joined by its motion, with the
    covariances added (NeighborMerged).

    Raises:
        DecisionError: a node is not in the map, or none would be left.
    """
    gone = sorted(set(node_ids))
    for node_id in gone:
        if node_id not in graph:
            raise DecisionError(f"node {node_id} is not in the map")
    if len(gone) == len(graph):
        raise DecisionError("these are all nodes of the map: none would be left")
    links = {pair: link for pair, link in graph.links.items() if set(pair) & set(gone)}
    cuts = [_entry("cut", link, None, author) for _, link in sorted(links.items())]
    bridges = [_entry("bridge", None, link, author) for _, link in sorted(bridged(graph, gone).items())]
    weights, labels = _columns(reader)
    drops = [_dropped(graph, node_id, weights[node_id], labels[node_id], author) for node_id in gone]
    return [*drops, *cuts, *bridges]


def bridged(graph: PoseGraph, gone: Sequence[int]) -> dict[Pair, Link]:
    """Links of odometry between nodes that stay, over those that go, by both ids, smaller first."""
    steps: dict[int, dict[int, Link]] = {}
    for link in graph.links.values():
        if link.type in _STEPS:
            steps.setdefault(link.from_id, {})[link.to_id] = link
            steps.setdefault(link.to_id, {})[link.from_id] = link
    made: dict[Pair, Link] = {}
    left = set(gone)
    for middle in gone:
        around = steps.pop(middle, {})
        for other in around:
            steps[other].pop(middle, None)
        ends = sorted(around)
        for old, new in pairwise(ends):
            stay = old not in left and new not in left
            if new not in steps[old] and not (stay and (old, new) in graph.links):
                link = composed(around[new], around[old], new, middle, old, LinkType.NEIGHBOR_MERGED)
                steps[old][new] = steps[new][old] = made[old, new] = link
    return {pair: link for pair, link in made.items() if not set(pair) & left}


def labelling(
    graph: PoseGraph, reader: MapReader, node_ids: Sequence[int], label: str, author: str
) -> list[JournalEntry]:
    """Entries that give nodes a label, numbered by their ids where there are several (a label is of one node alone).

    An empty label takes away those that there are; nodes without one are left alone.

    Raises:
        DecisionError: a node is not in the map, none would change, or another node has a label that is wanted.
    """
    ids, text = sorted(set(node_ids)), label.strip()
    for node_id in ids:
        if node_id not in graph:
            raise DecisionError(f"node {node_id} is not in the map")
    weights, labels = _columns(reader)
    texts = dict.fromkeys(ids, text)
    if text and len(ids) > 1:
        texts = {node_id: f"{text} {number}" for number, node_id in enumerate(ids, 1)}
    wanted = {node_id: text for node_id, text in texts.items() if labels[node_id] != text}
    if not wanted:
        raise DecisionError(_nothing_to_label(ids, text))
    holders = {known: node_id for node_id, known in labels.items() if known}
    for node_id, text in wanted.items():
        _check_label(node_id, text, holders)
    return [
        _labelled(graph, node_id, weights[node_id], labels[node_id], text, author) for node_id, text in wanted.items()
    ]


def _nothing_to_label(ids: Sequence[int], text: str) -> str:
    if not ids:
        return "nothing to label: no node is named"
    if len(ids) == 1:
        return f"node {ids[0]} has the label {text!r} already" if text else f"node {ids[0]} has no label"
    have = "nodes have these labels already" if text else "nodes have no label"
    return f"these {len(ids)} {have}"


def _check_label(node_id: int, text: str, holders: Mapping[str, int]) -> None:
    if len(text) > _LONGEST_LABEL or not text.isprintable():
        raise DecisionError(f"a label is at most {_LONGEST_LABEL} printable characters")
    if text in holders:
        raise DecisionError(f"label {text!r} can't be given to node {node_id}: node {holders[text]} has it")


def _labelled(graph: PoseGraph, node_id: int, weight: int, before: str, after: str, author: str) -> JournalEntry:
    change = _change(graph, node_id, (weight, weight), (before, after))
    note = f"{before or 'no label'} -> {after or 'no label'}"
    return JournalEntry(action="label", from_id=node_id, to_id=node_id, author=author, note=note, node=change)


def _columns(reader: MapReader) -> tuple[Mapping[int, int], Mapping[int, str]]:
    table = reader.nodes()
    ids = table.ids.tolist()
    labels = [label or "" for label in table.labels]
    return dict(zip(ids, table.weights.tolist(), strict=True)), dict(zip(ids, labels, strict=True))


def _dropped(graph: PoseGraph, node_id: int, weight: int, label: str, author: str) -> JournalEntry:
    change = _change(graph, node_id, (weight, WEIGHT_INVALID), (label, label))
    return JournalEntry(action="drop", from_id=node_id, to_id=node_id, author=author, node=change)


def _change(graph: PoseGraph, node_id: int, weights: tuple[int, int], labels: tuple[str, str]) -> NodeChange:
    return NodeChange(
        node_id=node_id,
        map_id=graph.map_ids[node_id],
        weight_before=weights[0],
        weight_after=weights[1],
        label_before=labels[0],
        label_after=labels[1],
        T_odom_base=graph.T_odom[node_id],
        T_map_base=graph.poses[node_id],
        constraints=tuple(link for key, link in sorted(graph.constraints.items()) if key[0] == node_id),
    )


def _entry(action: str, before: Link | None, after: Link | None, author: str) -> JournalEntry:
    link = before or after
    assert link is not None
    return JournalEntry(
        action=action, from_id=link.from_id, to_id=link.to_id, author=author, link_before=before, link_after=after
    )
