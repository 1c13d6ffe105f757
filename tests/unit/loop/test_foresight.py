"""Another threshold: what stays, goes and comes, and that the threshold in force changes nothing."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from slam.loop.foresight import Hypothesis, Outcome, foresee
from slam.types import Candidate, Link, LinkType, Refusal
from tests.graphs import INFORMATION


def link(new: int, old: int, kind: LinkType = LinkType.GLOBAL_CLOSURE) -> Link:
    return Link(new, old, kind, np.eye(4), INFORMATION)


def tried(new: int, old: int, *, good: bool) -> Candidate:
    refusal = None if good else Refusal("Vis/MinInliers", 7.0, 20.0, "7 inliers, fewer than Vis/MinInliers 20")
    T = np.eye(4) if good else None
    return Candidate(new, old, LinkType.GLOBAL_CLOSURE, 0.1, 50, 40 if good else 7, T, INFORMATION, refusal)


LINKS = {
    (1, 31): link(31, 1),
    (2, 32): link(32, 2),
    (3, 33): link(33, 3, LinkType.LOCAL_SPACE_CLOSURE),
    (4, 34): link(34, 4),
}
TRIED = {(5, 35): tried(35, 5, good=False), (6, 36): tried(36, 6, good=True)}
IN_FORCE = 0.11
_INSIDE = ("stays", "comes", "untried")
BELIEVED = [Hypothesis(30 + k, k, value) for k, value in enumerate((0.5, 0.2, 0.3, 0.15, 0.4, 0.1, 0.05), start=1)]


def outcomes(threshold: float, held: tuple[tuple[int, int], ...] = ()) -> dict[tuple[int, int], str]:
    found = foresee(BELIEVED, LINKS, TRIED, held, threshold, IN_FORCE)
    return {one.hypothesis.pair: one.outcome.value for one in found}


def test_at_the_threshold_in_force_nothing_comes_or_goes() -> None:
    found = outcomes(IN_FORCE)
    assert found == {(1, 31): "stays", (2, 32): "stays", (3, 33): "stays", (4, 34): "stays", (5, 35): "refused"}


def test_a_higher_one_lets_loops_go_but_not_those_of_proximity() -> None:
    assert outcomes(0.35) == {(1, 31): "stays", (2, 32): "goes", (4, 34): "goes", (5, 35): "refused"}


def test_a_lower_one_brings_what_the_images_agree_with() -> None:
    found = outcomes(0.01)
    assert found[(6, 36)] == "comes"
    assert found[(7, 37)] == "untried"
    (new,) = [one for one in foresee(BELIEVED, LINKS, TRIED, (), 0.01, IN_FORCE) if one.outcome is Outcome.COMES]
    assert new.link is not None
    assert (new.link.from_id, new.link.to_id) == (36, 6)


def test_what_somebody_decided_stays_decided() -> None:
    held = ((2, 32), (6, 36))
    assert (2, 32) not in outcomes(0.35, held)
    assert outcomes(0.01, held)[(6, 36)] == "refused"


@given(low=st.floats(0.0, 1.0), high=st.floats(0.0, 1.0))
def test_a_higher_threshold_never_lets_more_in(low: float, high: float) -> None:
    low, high = min(low, high), max(low, high)
    now, then = ({pair for pair, what in outcomes(t).items() if what in _INSIDE} for t in (low, high))
    assert then <= now


def test_what_reached_the_threshold_in_the_run_and_is_no_loop_was_refused_then() -> None:
    unknown = [Hypothesis(40, 10, 0.3), Hypothesis(41, 11, 0.08)]
    found = foresee(unknown, {}, {}, (), 0.05, IN_FORCE)
    assert [one.outcome for one in found] == [Outcome.REFUSED, Outcome.UNTRIED]
