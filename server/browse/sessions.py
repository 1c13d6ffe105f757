"""The sessions of a map, and which of them links join."""

from __future__ import annotations

from collections.abc import Iterable

from server.schemas import SessionFacts
from slam.database import Faults, MapReader, NodeTable
from slam.graph.components import components
from slam.types import Link


def session_list(reader: MapReader, nodes: NodeTable, links: Iterable[Link], faults: Faults) -> list[SessionFacts]:
    """Each session: number, nodes, source, whether it was closed in order, and those that it is one map with.

    Rows that make no sense go to ``faults``.
    """
    map_id_of = dict(zip(nodes.ids.tolist(), nodes.map_ids.tolist(), strict=True))
    pairs = [link.pair for link in links if link.from_id in map_id_of and link.to_id in map_id_of]
    piece_of = components(map_id_of.values(), ((map_id_of[a], map_id_of[b]) for a, b in pairs))
    return [
        SessionFacts(
            map_id=row.map_id,
            nodes=row.nodes,
            source=row.source,
            clean=row.clean,
            joined_with=sorted(
                i for i, piece in piece_of.items() if i != row.map_id and piece == piece_of.get(row.map_id)
            ),
        )
        for row in reader.sessions(faults)
    ]
