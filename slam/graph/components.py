"""Which nodes of a graph hang together."""

from __future__ import annotations

from collections.abc import Iterable


def components(ids: Iterable[int], pairs: Iterable[tuple[int, int]]) -> dict[int, int]:
    """Id -> the smallest id that links (pairs of these ids) join it with, itself where it stands alone."""
    first = {node_id: node_id for node_id in ids}

    def root(node_id: int) -> int:
        while first[node_id] != node_id:
            first[node_id] = first[first[node_id]]
            node_id = first[node_id]
        return node_id

    for a, b in pairs:
        low, high = sorted((root(a), root(b)))
        first[high] = low
    return {node_id: root(node_id) for node_id in first}
