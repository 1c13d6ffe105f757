"""Whoever follows a graph by increments has, at every moment, the graph as it is."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from server.browse.increments import Increments
from slam.types import Tier


@dataclass
class MadeUp:
    """The parts of a snapshot that increments look at."""

    revision: int
    poses: dict[int, Any]
    tiers: dict[int, Tier]
    residuals: dict[tuple[int, int], float]
    links: dict[tuple[int, int], None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.links = dict.fromkeys(self.residuals)

    @property
    def nodes(self) -> Any:
        ids = np.array(sorted(self.poses), dtype=np.int32)
        return _Table(ids, np.zeros(len(ids), dtype=np.int32))


@dataclass
class _Table:
    ids: Any
    weights: Any

    def __len__(self) -> int:
        return len(self.ids)


def pose(x: int) -> Any:
    matrix = np.eye(4)
    matrix[0, 3] = x
    return matrix


NODES = st.dictionaries(st.integers(1, 6), st.tuples(st.integers(0, 3), st.sampled_from(list(Tier))), max_size=6)
LINKS = st.dictionaries(st.tuples(st.integers(1, 3), st.integers(4, 6)), st.integers(0, 3), max_size=4)


@given(st.lists(st.tuples(NODES, LINKS, st.booleans()), min_size=1, max_size=8))
def test_followers_end_up_with_what_is_there(states: list[tuple[Any, Any, bool]]) -> None:
    increments = Increments()
    have_nodes: dict[int, Any] = {}
    have_links: dict[tuple[int, int], Any] = {}
    after = 0
    for revision, (nodes, links, looks) in enumerate(states, start=1):
        made = MadeUp(
            revision,
            {i: pose(x) for i, (x, _) in nodes.items()},
            {i: tier for i, (_, tier) in nodes.items()},
            {pair: float(sigma) for pair, sigma in links.items()},
        )
        if not looks:
            continue
        changed = increments.since(after, made)  # type: ignore[arg-type]
        if changed is None:
            have_nodes, have_links = dict(nodes), dict(links)
        else:
            have_nodes.update({i: nodes[i] for i in changed[0]})
            have_links.update({pair: links[pair] for pair in changed[1]})
        after = revision
        assert (have_nodes, have_links) == (nodes, links)
        assert increments.since(after, made) == (set(), set())  # type: ignore[arg-type]


def test_a_revision_of_before_a_restart_gets_everything() -> None:
    made = MadeUp(3, {1: pose(0)}, {1: Tier.WM}, {})
    assert Increments().since(57, made) is None  # type: ignore[arg-type]
    assert Increments().since(0, made) is None  # type: ignore[arg-type]
