"""How nodes outside RAM follow a map that is bent: each hangs on nodes in RAM, and moves as these do."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from slam.geometry import Array, Pose

#: Holders of a node: between two, a node on a way that was bent shares the bend by how near it is to either end.
_MOST = 2


@dataclass(frozen=True, slots=True)
class Holder:
    """A node that another one hangs on, and with which weight."""

    node_id: int
    weight: float


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

    def follow(self, moves: Mapping[int, Pose], in_ram: Container[int], poses: Mapping[int, Pose]) -> dict[int, Pose]:
        """Where nodes go whose holders moved: id -> (4, 4) ``T_map_node``.

        Args:
            moves: id of a node in RAM -> (4, 4) ``T_after_before``, its motion in the map's frame.
            in_ram: ids of those that hang on nothing.
            poses: of the nodes that hang, before.
        """
        held = {i: self._shortened(i, in_ram) for i in self}
        ids = [i for i, holders in held.items() if i in poses and any(h.node_id in moves for h in holders)]
        if not ids:
            return {}
        still = np.eye(4)
        T_before = np.array([poses[i] for i in ids])
        first = np.array([moves.get(held[i][0].node_id, still) for i in ids]) @ T_before
        last = np.array([moves.get(held[i][-1].node_id, still) for i in ids]) @ T_before
        return dict(zip(ids, _blended(first, last, np.array([held[i][0].weight for i in ids])), strict=True))

    def _shortened(self, node_id: int, in_ram: Container[int]) -> tuple[Holder, ...]:
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
        return self._holders[node_id]

    def _is_up(self, node_id: int, in_ram: Container[int]) -> bool:
        """Whether a holder hangs on others itself."""
        return node_id not in in_ram and node_id in self._holders

    def _through(self, holder: Holder, in_ram: Container[int]) -> list[Holder]:
        if not self._is_up(holder.node_id, in_ram):
            return [holder]
        return [Holder(above.node_id, holder.weight * above.weight) for above in self._holders[holder.node_id]]


def _surest(holders: Sequence[Holder]) -> tuple[Holder, ...]:
    """The heaviest holders, each node once, with weights that sum to one."""
    weights: dict[int, float] = {}
    for holder in holders:
        weights[holder.node_id] = weights.get(holder.node_id, 0.0) + holder.weight
    kept = sorted(weights.items(), key=lambda one: (-one[1], one[0]))[:_MOST]
    total = sum(weight for _, weight in kept)
    return tuple(Holder(node_id, weight / total) for node_id, weight in kept)


def _blended(first: Array, last: Array, share: Array) -> Array:
    """Weighted mean of positions and rotations of two stacks of poses (N, 4, 4), with this share (N,) of the first."""
    mean = share[:, None, None] * first + (1.0 - share)[:, None, None] * last
    U, _, Vt = np.linalg.svd(mean[:, :3, :3])
    U[:, :, 2] *= np.linalg.det(U @ Vt)[:, None]
    mean[:, :3, :3] = U @ Vt
    return mean
