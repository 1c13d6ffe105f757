"""Loop detection of one update: belief over places, then the candidates that the images were asked about."""

from __future__ import annotations

from dataclasses import dataclass

from slam.clock import StageClock
from slam.graph.graph import PoseGraph
from slam.loop.appearance import AppearanceLoops, verify
from slam.loop.bayes import BayesFilter
from slam.loop.epipolar import epipolar_refusal
from slam.loop.likelihood import adjust, raw_likelihood
from slam.loop.local_bundle import nodes_beside
from slam.loop.proximity import nearby
from slam.loop.proximity_scans import by_scans
from slam.memory.memory import Memory
from slam.memory.signature import too_few_words
from slam.params import Params
from slam.types import Candidate, LinkType, Node, Posterior


@dataclass(frozen=True, slots=True, eq=False)
class Belief:
    """What one update believes: the posterior (None for a node with too few words), and the place worth trying.

    Attributes:
        posterior: over working memory.
        place: id that passed ``Rtabmap/LoopThr``, 0 for none.
        refused: text of why the best hypothesis was not tried, empty when it was.
    """

    posterior: Posterior | None
    place: int = 0
    refused: str = ""

    @property
    def likelihood(self) -> dict[int, float]:
        """Likelihood of each place."""
        if self.posterior is None:
            return {}
        return dict(zip(self.posterior.node_ids.tolist(), self.posterior.likelihood.tolist(), strict=True))


class LoopDetector:
    """Bayes filter, appearance and proximity, in RTAB-Map's order."""

    def __init__(self) -> None:
        self._bayes = BayesFilter()
        self._appearance = AppearanceLoops()

    def recognize(
        self, node: Node, memory: Memory, graph: PoseGraph, params: Params, clock: StageClock, *, home: int = 0
    ) -> Belief:
        """Belief over working memory after seeing a node; ``home`` is a node of the graph that it is known to be in."""
        bag = memory.bags[node.id]
        bad = too_few_words(bag, memory, params)
        if bad is not None:
            return Belief(None, refused=bad.text)
        places = sorted(memory.wm)
        with clock.stage("Timing/Likelihood_computation/ms"):
            others = [memory.bags[i] for i in memory.stm]
            scores = raw_likelihood(bag, [memory.bags[i] for i in places], others, params)
            likelihood, virtual = adjust(scores, params)
        with clock.stage("Timing/Posterior_computation/ms"):
            posterior = self._bayes.update(places, likelihood, virtual, graph, params)
        connected = posterior.best_id == 0 or posterior.best_id in graph.component(home or node.id)
        refusal = self._appearance.hypothesis(posterior, connected=connected, params=params)
        if refusal is None:
            refusal = epipolar_refusal(node, memory.nodes[posterior.best_id], params)
        if refusal is not None:
            return Belief(posterior, refused=refusal.text)
        return Belief(posterior, place=posterior.best_id)

    def candidates(
        self,
        node: Node,
        belief: Belief,
        memory: Memory,
        graph: PoseGraph,
        params: Params,
        clock: StageClock,
        *,
        home: int = 0,
    ) -> list[Candidate]:
        """Registers the node with the place believed in and with what is near by, on paths that lead to ``home``."""
        found: list[Candidate] = []
        if params.RGBD.ProximityByTime:
            with clock.stage("Timing/Proximity_by_time/ms"):
                found += [
                    verify(node, memory.nodes[i], LinkType.LOCAL_TIME_CLOSURE, float("nan"), params)
                    for i in memory.stm
                    if i != node.id and i not in dict(graph.places_beside(node.id))
                ]
        with clock.stage("Timing/Hypotheses_validation/ms"):
            # Odometry has joined them already when the last node is in working memory (Mem/STMSize 1).
            joined = belief.place in dict(graph.places_beside(node.id))
            if belief.place and belief.posterior is not None and not joined:
                found.append(
                    verify(
                        node,
                        memory.nodes[belief.place],
                        LinkType.GLOBAL_CLOSURE,
                        belief.posterior.value,
                        params,
                        beside=nodes_beside(belief.place, memory.nodes, graph, params),
                    )
                )
        if not params.RGBD.ProximityBySpace:
            return found
        with clock.stage("Timing/Proximity_by_space/ms"):
            for place in nearby(node.id, memory.wm, graph, belief.likelihood, params, home=home):
                if place != belief.place:
                    old, beside = memory.nodes[place], nodes_beside(place, memory.nodes, graph, params)
                    kind = LinkType.LOCAL_SPACE_CLOSURE
                    found.append(verify(node, old, kind, float("nan"), params, beside=beside))
            if params.RGBD.ProximityPathMaxNeighbors > 0 and params.Reg.Strategy > 0:
                found.extend(by_scans(node, memory, graph, belief.likelihood, found, params))
        return found
