"""Which loops another ``Rtabmap/LoopThr`` would have let in or kept out, by what the updates believed."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum

from slam.graph.graph import Pair
from slam.types import Candidate, Link, LinkType


class Outcome(StrEnum):
    """What would become of a hypothesis."""

    STAYS = "stays"
    GOES = "goes"
    COMES = "comes"
    REFUSED = "refused"
    UNTRIED = "untried"


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """The best place of an update: node, place, and the value that LoopThr is compared with.

    ``needed`` is LoopThr as that update had it, None where it is the map's.
    """

    node_id: int
    place_id: int
    value: float
    needed: float | None = None

    @property
    def pair(self) -> Pair:
        """Both ids, smaller first."""
        return min(self.node_id, self.place_id), max(self.node_id, self.place_id)


@dataclass(frozen=True, slots=True, eq=False)
class Foreseen:
    """A hypothesis that matters at some threshold.

    Attributes:
        hypothesis: of an update.
        outcome: at that threshold.
        link: of the graph, or the one that would come; None where it is not tried or was refused.
        candidate: what the images said when it was tried, then or now.
    """

    hypothesis: Hypothesis
    outcome: Outcome
    link: Link | None = None
    candidate: Candidate | None = None


def foresee(
    hypotheses: Iterable[Hypothesis],
    links: Mapping[Pair, Link],
    tried: Mapping[Pair, Candidate],
    held: Collection[Pair],
    threshold: float,
    in_force: float,
) -> list[Foreseen]:
    """The loops of a map as they would be at another threshold, update by update.

    What an update believed is taken as it was: that other loops would have changed weights and beliefs later on is
    left out, as is ``RGBD/AggressiveLoopThr``.

    Args:
        hypotheses: of the updates that computed one.
        links: of the graph.
        tried: candidates that were registered, in the run or since.
        held: pairs that somebody decided about, which stay as they are.
        threshold: instead of ``Rtabmap/LoopThr``.
        in_force: what that was in the run; what reached it and is no loop was refused then.

    Returns:
        Those that reach the threshold, and those that are loops and don't.
    """
    found = []
    for hypothesis in hypotheses:
        link, candidate = links.get(hypothesis.pair), tried.get(hypothesis.pair)
        outcome = _outcome(hypothesis, link, held, threshold)
        if outcome is Outcome.UNTRIED and candidate is not None:
            outcome = Outcome.REFUSED if candidate.refusal is not None else Outcome.COMES
        elif outcome is Outcome.UNTRIED and hypothesis.value >= (hypothesis.needed or in_force):
            outcome = Outcome.REFUSED
        if outcome is not None:
            new = candidate.link if outcome is Outcome.COMES and candidate is not None else link
            found.append(Foreseen(hypothesis, outcome, new, candidate))
    return found


def _outcome(hypothesis: Hypothesis, link: Link | None, held: Collection[Pair], threshold: float) -> Outcome | None:
    reaches = hypothesis.value >= threshold
    if link is not None:
        # Proximity needs no hypothesis; neighbours in time are joined anyhow.
        if link.type is not LinkType.GLOBAL_CLOSURE or hypothesis.pair in held:
            return Outcome.STAYS if reaches and link.type.is_loop else None
        return Outcome.STAYS if reaches else Outcome.GOES
    if not reaches:
        return None
    return Outcome.REFUSED if hypothesis.pair in held else Outcome.UNTRIED
