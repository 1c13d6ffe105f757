"""The part of the graph that is worked on: the nodes in RAM, with what lies between them condensed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from slam.geometry import Pose, between, inverse
from slam.graph.composition import composed
from slam.graph.graph import PoseGraph
from slam.graph.optimizer import optimize
from slam.graph.verify import Closure, close_loops, max_error
from slam.memory.hanging import Hanging, Holder
from slam.memory.window import window
from slam.params import Params
from slam.types import Link, LinkType

#: Neighbours of a node that leaves get no link over it when they are this near by other links: else each loop that
#: ever was would leave a link behind, and the graph would grow dense.
_NEAR = 3
#: Nodes around a loop that are fitted to it, and how many where these don't fit.
_WINDOWS = (40, 160)
#: Surroundings with a link this many sigmas off were bent from afar, and are fitted before a loop is held against them.
_STRAINED = 5.0
#: Metres, or an entry of a rotation: who moves less is not followed.
_STILL = 1e-7


class ActiveGraph:
    """Keeps what an update costs within bounds, however large the map: only this graph is searched and optimised.

    As long as every node is in RAM it is the whole graph itself. A node that leaves is eliminated: virtual links join
    those of its neighbours that would be far apart without it, as the optimised poses have them and as sure as the two
    links on the way put together. The node hangs on its neighbours: when a far loop bends the map, it moves as they do.
    When it comes back it gets its links again. Loops near by are fitted to nodes outside RAM too (``window``).

    Attributes:
        whole: all nodes of the map, with all their links; poses are always up to date.
        graph: nodes in RAM, their links, and virtual ones over what is not in RAM.
    """

    def __init__(self, whole: PoseGraph) -> None:
        self.whole = whole
        self.graph = whole
        self._hanging = Hanging()
        # Links that a node had when it left, each with the absent node that it stood for (0: a real link).
        self._had: dict[int, list[tuple[Link, int]]] = {}
        # Virtual links in the graph, and the absent node that each stands for.
        self._over: dict[Link, int] = {}
        self._moved: set[int] = set()

    @property
    def is_whole(self) -> bool:
        """Whether every node of the map is in it."""
        return self.graph is self.whole

    def restrict(self, node_ids: Iterable[int]) -> None:
        """Makes it anew from the whole graph, without these nodes."""
        self.graph, self._hanging, self._had, self._over = self.whole, Hanging(), {}, {}
        self.leave(sorted(node_ids))

    def add_node(self, node_id: int, map_id: int, T_odom_base: Pose, T_map_base: Pose) -> None:
        """A new node."""
        self.whole.add_node(node_id, map_id, T_odom_base, T_map_base)
        if not self.is_whole:
            self.graph.add_node(node_id, map_id, T_odom_base, T_map_base)

    def mark_between(self, node_id: int) -> None:
        """A node in RAM is an intermediate one."""
        self.whole.between.add(node_id)
        self.graph.between.add(node_id)

    def remove_node(self, node_id: int) -> None:
        """Takes out a node in RAM."""
        self.whole.remove_node(node_id)
        if not self.is_whole:
            self.graph.remove_node(node_id)

    def merge(self, node_id: int, into: int, links: Iterable[Link]) -> None:
        """A node in RAM becomes part of another one there, which gets these links; what hung on it hangs on that."""
        self._hanging.hang(node_id, [Holder(into, 1.0)])
        for link in [link for link in self._over if node_id in link.pair]:
            del self._over[link]
        self.remove_node(node_id)
        for link in links:
            self.add_link(link)

    def add_link(self, link: Link) -> None:
        """A new link of nodes in RAM."""
        self.whole.add_link(link)
        if not self.is_whole:
            self.graph.add_link(link)

    def add_constraint(self, link: Link) -> None:
        """A new prior or gravity of a node in RAM."""
        self.whole.add_constraint(link)
        if not self.is_whole:
            self.graph.add_constraint(link)

    def place(self, node_id: int, T_map_base: Pose) -> None:
        """A node in RAM lies elsewhere."""
        self.whole.poses[node_id] = T_map_base
        self.graph.poses[node_id] = T_map_base

    def try_loops(self, graph: PoseGraph, links: Sequence[Link], params: Params) -> Closure:
        """Like ``close_loops`` on ``graph``, where the links close small circles on their surroundings alone.

        Those are what such a loop is about, and are fitted to it by real links, those of nodes outside RAM too. A loop
        that leads far beyond them bends all that is in RAM.
        """
        if self.is_whole:
            return close_loops(graph, links, params)
        return self._try_near(links, params) or self._try_far(graph, links, params)

    def _try_near(self, links: Sequence[Link], params: Params) -> Closure | None:
        """In the surroundings, and in larger ones when these don't fit; None where they don't join the ends."""
        ids, closure = sorted({i for link in links for i in link.pair}), None
        for size in _WINDOWS:
            part = window(self.whole, self.graph, ids, size)
            if not set(ids) <= part.component(ids[0]):
                continue
            if max_error(part, part.poses).ratio > _STRAINED:
                part.poses = optimize(part, params).poses
                self._take_in(part)
            closure = close_loops(part, links, params)
            if closure.accepted:
                self._take_in(part, links)
                break
        return closure

    def _try_far(self, graph: PoseGraph, links: Sequence[Link], params: Params) -> Closure:
        self._rest()
        return close_loops(graph, links, params, at_rest=self._is_at_rest)

    @property
    def _is_at_rest(self) -> bool:
        """Whether no link that the poses follow was taken out a moment ago."""
        linked = ((i, other) for i in self.graph.poses for other in self.whole.neighbors(i))
        return all(other in self.graph.neighbors(i) for i, other in linked if other in self.graph)

    def _take_in(self, part: PoseGraph, links: Sequence[Link] = ()) -> None:
        moved = {i: T for i, T in part.poses.items() if i not in part.held}
        self.whole.poses.update(moved)
        self.graph.poses = {i: moved.get(i, T) for i, T in self.graph.poses.items()}
        self._moved |= moved.keys() - self.graph.poses.keys()
        for link in links:
            self.whole.add_link(link)
            self.graph.add_link(link)

    def _rest(self) -> None:
        """What virtual links say is where things are now: the map, left alone, is at rest."""
        for link, middle in list(self._over.items()):
            if link.type is LinkType.VIRTUAL_CLOSURE:
                del self._over[link]
                self.graph.remove_link(link.pair)
                T = between(self.whole.poses[link.from_id], self.whole.poses[link.to_id])
                self._bridge(replace(link, T_from_to=T), middle)

    def closed(self, links: Iterable[Link], removed: Iterable[Link] = ()) -> None:
        """Loop links were added to ``graph`` (and removed), which was optimised so: the whole graph gets it all."""
        if self.is_whole:
            return
        for link in removed:
            self.whole.remove_link(link.pair)
        for link in links:
            if link.pair not in self.whole.links:
                self.whole.add_link(link)
        old, new = self.whole.poses, self.graph.poses
        moves = {i: T @ inverse(old[i]) for i, T in new.items() if np.abs(T - old[i]).max() > _STILL}
        followed = self._hanging.follow(moves, self.graph, old) if moves else {}
        self.whole.poses.update(followed)
        self.whole.poses.update(new)
        self._moved |= followed.keys()

    def leave(self, node_ids: Iterable[int]) -> None:
        """Nodes go to long-term memory."""
        ids = [node_id for node_id in node_ids if node_id in self.graph]
        if ids and self.is_whole:
            self.graph = _copy(self.whole)
        for node_id in ids:
            self._eliminate(node_id)

    def come_back(self, node_ids: Iterable[int]) -> None:
        """Nodes come from long-term memory."""
        for node_id in node_ids:
            if node_id in self.graph:
                continue
            T_map_base = self.whole.poses[node_id]
            holder = self._hanging.take_down(node_id)
            self.graph.add_node(node_id, self.whole.map_ids[node_id], self.whole.T_odom[node_id], T_map_base)
            if node_id in self.whole.between:
                self.graph.between.add(node_id)
            self._restore(node_id)
            if holder and not self.graph.neighbors(node_id) and self.whole.neighbors(node_id):
                self._tie(node_id, holder)

    def take_moved(self) -> set[int]:
        """Ids outside RAM whose pose changed since this was last asked."""
        moved, self._moved = self._moved, set()
        return moved

    def _eliminate(self, node_id: int) -> None:
        links = dict(self.graph.neighbors(node_id))
        self._hanging.hang(
            node_id, [Holder(other, float(np.trace(link.information[:3, :3]))) for other, link in links.items()]
        )
        self._had[node_id] = [(link, self._over.pop(link, 0)) for link in links.values()]
        self.graph.remove_node(node_id)
        for a, b in zip(sorted(links), sorted(links)[1:], strict=False):
            if b not in self.graph.within(a, _NEAR):
                by_links = composed(links[a], links[b], a, node_id, b, LinkType.VIRTUAL_CLOSURE)
                T_a_b = between(self.graph.poses[a], self.graph.poses[b])
                self._bridge(replace(by_links, T_from_to=T_a_b), node_id)

    def _restore(self, node_id: int) -> None:
        """A node that came back has its real links and those that it had when it left, in place of those over it."""
        over = [link for link, middle in self._over.items() if middle == node_id]
        for link in over:
            del self._over[link]
            self.graph.remove_link(link.pair)
        for link, middle in self._had.pop(node_id, []):
            if self._fits(link) and middle not in self.graph:
                self._bridge(link, middle)
        for link in self.whole.neighbors(node_id).values():
            if self._fits(link):
                self.graph.add_link(link)
        for (from_id, _, _), link in self.whole.constraints.items():
            if from_id == node_id:
                self.graph.add_constraint(link)
        self._keep_together(over, node_id)

    def _keep_together(self, over: Iterable[Link], node_id: int) -> None:
        """Virtual links over a node that is back stay where the way through it goes on over other absent nodes."""
        absent = next((i for i in self.whole.neighbors(node_id) if i not in self.graph), node_id)
        for link in over:
            if link.to_id not in self.graph.component(link.from_id):
                self._bridge(link, absent)

    def _fits(self, link: Link) -> bool:
        return self.graph.has(*link.pair) and link.pair not in self.graph.links

    def _bridge(self, link: Link, middle: int) -> None:
        """Adds a link that stands for an absent node (0: a real link)."""
        self.graph.add_link(link)
        if middle:
            self._over[link] = middle

    def _tie(self, node_id: int, other: int) -> None:
        """Joins a node with the one in RAM that it hung on, as sure as a link that bridges the whole gap can be."""
        while other not in self.graph:
            if other not in self._hanging:
                return
            other = self._hanging.first_holder(other)
        T = between(self.graph.poses[node_id], self.graph.poses[other])
        gap = max(1, abs(node_id - other))
        absent, sample = next(iter(self.whole.neighbors(node_id).items()))
        self._bridge(Link(node_id, other, LinkType.VIRTUAL_CLOSURE, T, sample.information / gap), absent)


def _copy(graph: PoseGraph) -> PoseGraph:
    copy = PoseGraph()
    copy.between = set(graph.between)
    for node_id, T_odom_base in graph.T_odom.items():
        copy.add_node(node_id, graph.map_ids[node_id], T_odom_base, graph.poses[node_id])
    for link in graph.links.values():
        copy.add_link(link)
    for link in graph.constraints.values():
        copy.add_constraint(link)
    return copy
