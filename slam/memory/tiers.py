"""The memories and the graph that is worked on, in step."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

from slam.database import Reduction
from slam.errors import OptimizationError
from slam.geometry import Pose
from slam.graph.graph import PoseGraph
from slam.graph.optimizer import optimize
from slam.loop.closing import Closed
from slam.memory.active_graph import ActiveGraph
from slam.memory.immunity import Immunity
from slam.memory.memory import Memory
from slam.memory.places import Places
from slam.memory.reduction import reduction, replacement
from slam.memory.retrieval import choose_retrieval
from slam.memory.transfer import choose_transfer, is_bounded
from slam.params import Params
from slam.types import LinkType


@dataclass(frozen=True, slots=True)
class Transfer:
    """The ids that went to long-term memory, and those that might not; none where memory has no bound."""

    ids: Sequence[int] = ()
    immunity: Immunity = field(default_factory=Immunity)


class Tiers:
    """Moves nodes between the memories, and keeps the working graph and the places of absent nodes as they say.

    Attributes:
        memory: the tiers.
        active: the graph of the nodes in RAM.
        last_loop: the old node of the last loop closure, 0 for none.
        labelled: nodes of this session that bear a label, and so never become part of another.
    """

    def __init__(self, memory: Memory, graph: PoseGraph) -> None:
        self.memory = memory
        self.active = ActiveGraph(graph)
        self.last_loop = 0
        self.labelled: set[int] = set()
        self._places = Places()
        self._moved: set[int] = set()
        self.restrict()

    @property
    def graph(self) -> PoseGraph:
        """All nodes of the map."""
        return self.active.whole

    def restrict(self) -> None:
        """Makes the working graph anew: somebody changed the whole one."""
        self.active.restrict(self.memory.with_between(sorted(self.memory.ltm)))
        self._places.put(self.graph.poses, sorted(self.memory.ltm))

    def reduce(self, node_ids: Iterable[int]) -> tuple[Reduction, ...]:
        """Nodes that leave short-term memory become part of an older one where a loop ties them to it."""
        done = []
        for node_id in node_ids:
            found = None if node_id in self.labelled else reduction(node_id, self.memory, self.active.graph)
            if found is not None:
                weight = self.memory.weights[found.into] + self.memory.weights[node_id]
                self.memory.set_weight(found.into, weight)
                self._merge(found)
                done.append(found)
        return tuple(done)

    def replace(self, node_id: int, by: int) -> tuple[Reduction, ...]:
        """The last node becomes part of a new one; or an intermediate one, where others lie between."""
        if self.last_loop == node_id:
            self.last_loop = by
        if by not in self.active.graph.neighbors(node_id):
            self.memory.make_between(node_id, by)
            self.active.mark_between(node_id)
            return ()
        if node_id in self.labelled:
            self.labelled.add(by)
        found = replacement(node_id, by, self.active.graph)
        self._merge(found)
        return (found,)

    def take_back(self, node_id: int) -> None:
        """A new node is not kept after all."""
        self.memory.dismiss(node_id)
        self.active.remove_node(node_id)
        self.labelled.discard(node_id)
        self._moved.discard(node_id)

    def _merge(self, found: Reduction) -> None:
        self.memory.hand_over(found.node_id, found.into)
        self.memory.dismiss(found.node_id)
        self.active.merge(found.node_id, found.into, found.links)
        self._moved.discard(found.node_id)

    def retrieve(self, node_id: int, best_id: int, params: Params) -> list[int]:
        """Brings back what belongs to the best hypothesis and to the place of a new node; the ids that came."""
        chosen = choose_retrieval(
            self.memory, self.graph, self._places, node_id=node_id, best_id=best_id, params=params
        )
        retrieved = self.memory.retrieve(chosen, params)
        self._places.drop(retrieved)
        together = self.memory.with_between(retrieved)
        self.active.come_back(together)
        self._moved.update(together)
        return retrieved

    def transfer(self, best_id: int, retrieved: list[int], elapsed_ms: float, params: Params) -> Transfer:
        """Moves what there is no time or room for to long-term memory."""
        if not is_bounded(params):
            return Transfer()
        immunity = Immunity.of(self.memory, self.graph, self.active.graph, best_id, self.last_loop, params)
        chosen = choose_transfer(
            self.memory, immune=immunity.ids, retrieved=retrieved, elapsed_ms=elapsed_ms, params=params
        )
        self.memory.transfer(chosen)
        self._places.put(self.graph.poses, chosen)
        self.active.leave(self.memory.with_between(chosen))
        return Transfer(chosen, immunity)

    def follow(self, node_id: int, closed: Closed) -> None:
        """All poses follow the optimised ones, in RAM and outside."""
        self._moved.add(node_id)
        if closed.optimized:
            self.active.closed(closed.links, closed.removed)
            self._moved.update(self.active.graph.poses)
            followed = self.active.take_moved()
            self._places.put(self.graph.poses, (i for i in followed if i in self.memory.ltm))
            self._moved.update(followed)

    def weigh(self, node_id: int, weight: int, closed: Closed, params: Params) -> int:
        """The new node's weight after loop closure: a place seen again hands its weight to its newest node.

        With ``Mem/ReduceGraph`` to its oldest, which stays.
        """
        for link in closed.links:
            if link.type is LinkType.GLOBAL_CLOSURE:
                self.last_loop = link.to_id
                both = weight + self.memory.weights[link.to_id]
                weight, older = (0, both) if params.Mem.ReduceGraph else (both, 0)
                self.memory.set_weight(link.to_id, older)
        self.memory.weights[node_id] = weight
        return weight

    def settle(self, params: Params) -> None:
        """What was put off to keep updates short is done: the whole graph fits together."""
        if not self.active.is_whole:
            with suppress(OptimizationError):
                self.graph.poses = optimize(self.graph, params).poses

    @property
    def moved(self) -> Iterable[int]:
        """Ids whose pose changed since this was last taken, ascending."""
        return sorted(self._moved)

    def take_poses(self) -> dict[int, Pose]:
        """Poses that changed since this was last asked."""
        poses = {i: self.graph.poses[i] for i in self.moved}
        self._moved = set()
        return poses
