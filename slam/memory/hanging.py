"""Where nodes outside RAM are: they hang on those in RAM that they were linked with, and move as these do."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass

from slam.geometry import Pose, interpolate

#: Holders of a node: between two, a node on a way that was bent shares the bend by how near it is to either end.
_MOST = 2


@dataclass(frozen=True, slots=True, eq=False)
class Holder:
    """A node that another one hangs on: with which weight, and where the other one is as seen from it."""

    node_id: int
    weight: float
    T_holder_node: Pose


class Hanging:
    """Nodes by what they hang on; a holder may have left RAM itself and hang on others, over any number of them.

    When a node leaves, its conditional mean given those that stay moves with each neighbour by the share that the
    neighbour's link has in its information (Dellaert and Kaess 2017, section 3.3.2), here one number for a link and
    the two surest links. Whoever looks a node up shortens its way to RAM, so that the next time it costs little.
    """

    def __init__(self) -> None:
        self._holders: dict[int, tuple[Holder, ...]] = {}

    def __contains__(self, node_id: int) -> bool:
        return node_id in self._holders

    def __iter__(self) -> Iterator[int]:
        return iter(list(self._holders))

    def hang(self, node_id: int, holders: Sequence[Holder]) -> None:
        """A node leaves RAM; the weights need not sum to one."""
        if holders:
            self._holders[node_id] = _surest(holders)

    def take_down(self, node_id: int) -> int:
        """A node comes back; the node in RAM that held it best, 0 when none did."""
        holders = self._holders.pop(node_id, ())
        return holders[0].node_id if holders else 0

    def first_holder(self, node_id: int) -> int:
        """The node that holds this one best."""
        return self._holders[node_id][0].node_id

    def pose(self, node_id: int, in_ram: Container[int], poses: Mapping[int, Pose]) -> Pose:
        """Pose of a node that hangs; of a holder that hangs on nothing itself, ``poses`` has the last one."""
        self._shorten(node_id, in_ram)
        first, *rest = self._holders[node_id]
        T_map_node: Pose = poses[first.node_id] @ first.T_holder_node
        for other in rest:
            T_map_node = interpolate(T_map_node, poses[other.node_id] @ other.T_holder_node, other.weight)
        return T_map_node

    def _shorten(self, node_id: int, in_ram: Container[int]) -> None:
        """Hang a node directly on what is in RAM (or hangs on nothing), and everything on its way too."""
        way = [node_id]
        while way:
            holders = self._holders[way[-1]]
            above = [h.node_id for h in holders if self._is_up(h.node_id, in_ram)]
            further = [i for i in above if any(self._is_up(h.node_id, in_ram) for h in self._holders[i])]
            if further:
                way += further
                continue
            if above:
                self._holders[way[-1]] = _surest([one for holder in holders for one in self._through(holder, in_ram)])
            way.pop()

    def _is_up(self, node_id: int, in_ram: Container[int]) -> bool:
        """Whether a holder hangs on others itself."""
        return node_id not in in_ram and node_id in self._holders

    def _through(self, holder: Holder, in_ram: Container[int]) -> list[Holder]:
        if not self._is_up(holder.node_id, in_ram):
            return [holder]
        return [
            Holder(above.node_id, holder.weight * above.weight, above.T_holder_node @ holder.T_holder_node)
            for above in self._holders[holder.node_id]
        ]


def _surest(holders: Sequence[Holder]) -> tuple[Holder, ...]:
    """The heaviest holders, each node once, with weights that sum to one."""
    by_id: dict[int, Holder] = {}
    for holder in sorted(holders, key=lambda one: (-one.weight, one.node_id)):
        known = by_id.get(holder.node_id)
        weight = holder.weight if known is None else known.weight + holder.weight
        T = holder.T_holder_node if known is None else known.T_holder_node
        by_id[holder.node_id] = Holder(holder.node_id, weight, T)
    kept = sorted(by_id.values(), key=lambda one: (-one.weight, one.node_id))[:_MOST]
    total = sum(one.weight for one in kept)
    return tuple(Holder(one.node_id, one.weight / total, one.T_holder_node) for one in kept)
