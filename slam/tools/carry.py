"""What people did to the files that are replayed, done to the new map: decisions, links made by hand, labels."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace

from slam.database import JournalEntry, MapReader, MapWriter
from slam.database.journal_rows import VERDICTS
from slam.errors import OptimizationError
from slam.graph.graph import PoseGraph
from slam.graph.verify import join
from slam.tools.ids import NewIds
from slam.types import Link, LinkType

#: Labels that the engine gives by itself.
_OWN_LABEL = re.compile(r"map\d+")


@dataclass(slots=True)
class Carried:
    """What became of it.

    Attributes:
        decisions: number that stand in the new map.
        links: number of links by hand in it.
        labels: number of labels.
        lost: what could not be done again, and why.
    """

    decisions: int = 0
    links: int = 0
    labels: int = 0
    lost: list[str] = field(default_factory=list)


def carry(writer: MapWriter, graph: PoseGraph, readers: Sequence[MapReader], ids: NewIds) -> Carried:
    """Do again what people did: graph, links and journal follow; poses are left to be optimised.

    A link by hand replaces what was found between its nodes. A loop that was approved and not found again is added,
    one that was rejected and found again is removed.
    """
    done = Carried()
    for file, reader in enumerate(readers):
        for entry in _made_by_hand(reader):
            _decide(writer, graph, file, reader, entry, ids, done)
        done.lost += _edited_odometry(reader)
    labels = _labels(readers, ids, done)
    writer.label_nodes(labels)
    done.labels = len(labels)
    return done


def _made_by_hand(reader: MapReader) -> list[JournalEntry]:
    """The last decision about each pair that stands, and the links by hand that no journal knows (RTAB-Map's)."""
    all_links = {link.pair: link for link in reader.links()}
    now = {pair: link for pair, link in all_links.items() if link.type is LinkType.USER_CLOSURE}
    last = {e.pair: e for e in reader.journal() if e.action in VERDICTS and e.undone_by is None}
    # A link by hand that was edited afterwards is what it is now.
    last |= {pair: replace(e, link_after=now[pair]) for pair, e in last.items() if e.action == "add" and pair in now}
    for entry in _edits(reader):
        # A loop of the engine that was edited or refined is taken over as it is now.
        if entry.pair not in last and entry.pair in all_links and all_links[entry.pair].type.is_loop:
            last[entry.pair] = replace(entry, action="add", link_after=all_links[entry.pair])
    links = [link for pair, link in now.items() if pair not in last]
    entries = [JournalEntry(action="add", from_id=k.from_id, to_id=k.to_id, link_after=k) for k in links]
    return [*entries, *sorted(last.values(), key=lambda entry: entry.id)]


def _edits(reader: MapReader) -> list[JournalEntry]:
    """Edits of links that stand."""
    known = ("refine", "edit", "covariance")
    return [
        entry for entry in reader.journal() if entry.action in known and entry.undone_by is None and entry.to_id > 0
    ]


def _edited_odometry(reader: MapReader) -> list[str]:
    """What is not done again: a replay has odometry as it was measured."""
    steps = {link.pair for link in reader.links() if not link.type.is_loop}
    found = sorted({(entry.action, entry.pair) for entry in _edits(reader) if entry.pair in steps})
    return [
        f"{action} {a}-{b} of {reader.path.name}: odometry is replayed as it was measured" for action, (a, b) in found
    ]


def _decide(
    writer: MapWriter,
    graph: PoseGraph,
    file: int,
    reader: MapReader,
    entry: JournalEntry,
    ids: NewIds,
    done: Carried,
) -> None:
    told = f"{entry.action} {entry.from_id}-{entry.to_id} of {reader.path.name}"
    from_id, to_id = ids.get(file, entry.from_id), ids.get(file, entry.to_id)
    if from_id is None or to_id is None or from_id == to_id:
        why = "both nodes became one" if from_id is not None and from_id == to_id else "a node is not in the new map"
        done.lost.append(f"{told}: {why}")
        return
    here = graph.links.get((min(from_id, to_id), max(from_id, to_id)))
    if here is not None and not here.type.is_loop:
        done.lost.append(f"{told}: odometry joins these nodes in the new map")
        return
    given = entry.link_after if entry.link_after is not None else entry.link_before
    made = None if given is None else ids.carried(file, given)
    note = f"{entry.note} ({told})" if entry.note else told
    new = replace(entry, id=0, from_id=from_id, to_id=to_id, link_before=None, link_after=None, undoes=None, note=note)
    try:
        _write(writer, graph, new, here, made)
    except OptimizationError as error:
        done.lost.append(f"{told}: {error}")
        return
    done.decisions += 1
    done.links += entry.action == "add"


def _write(writer: MapWriter, graph: PoseGraph, entry: JournalEntry, here: Link | None, made: Link | None) -> None:
    if entry.action == "reject":
        if here is not None:
            graph.remove_link(here.pair)
        remove = [] if here is None else [(here.from_id, here.to_id)]
        writer.append_decision(replace(entry, link_before=here), remove=remove, poses={})
    elif entry.action == "approve" and here is not None:
        writer.append_decision(replace(entry, link_before=here, link_after=here), poses={})
    elif made is None:
        raise OptimizationError("its transform is not in the journal")
    else:
        link = replace(made, type=LinkType.USER_CLOSURE)
        if here is not None:
            graph.remove_link(here.pair)
        join(graph, link)
        remove = [] if here is None else [(here.from_id, here.to_id)]
        writer.append_decision(replace(entry, action="add", link_after=link), add=[link], remove=remove, poses={})


def _labels(readers: Sequence[MapReader], ids: NewIds, done: Carried) -> dict[int, str]:
    found: dict[int, str] = {}
    for file, reader in enumerate(readers):
        table = reader.nodes()
        for node_id, label in zip(table.ids.tolist(), table.labels, strict=True):
            if not label or _OWN_LABEL.fullmatch(label):
                continue
            new_id = ids.get(file, node_id)
            if new_id is None or new_id in found:
                why = "the node is not in the new map" if new_id is None else "another label is on its node"
                done.lost.append(f"label {label!r} of node {node_id} of {reader.path.name}: {why}")
                continue
            found[new_id] = _free(label, found.values())
    return found


def _free(label: str, taken: Collection[str]) -> str:
    number, name = 1, label
    while name in taken:
        number += 1
        name = f"{label} {number}"
    return name
