"""Nodes are found by what is asked for, and by nothing else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from server.browse.map_view import MapView
from server.browse.search import matching
from server.browse.snapshot import Snapshot
from server.catalog import MapFile
from server.errors import QueryError
from tests.unit.server.loop_map import NODES

Found = Callable[[str], list[int]]


@pytest.fixture(scope="session")
def snapshot(written_map: Path) -> Snapshot:
    return MapView(MapFile("loops", "loops", written_map)).snapshot()


@pytest.fixture(scope="session")
def found(snapshot: Snapshot) -> Found:
    def find(query: str) -> list[int]:
        return [int(i) for i in snapshot.nodes.ids[matching(snapshot, snapshot.nodes, query)]]

    return find


@pytest.mark.parametrize(
    ("query", "ids"),
    [
        ("", list(range(1, NODES + 1))),
        ("1", [1, 10, 11, 12]),
        ("id:1", [1]),
        ("id:3..5", [3, 4, 5]),
        ("id:3-5", [3, 4, 5]),
        ("id:..2", [1, 2]),
        ("id:>10", [11, 12]),
        ("id:>=11 id:<12", [11]),
        ("weight:3 id:<8", [3, 7]),
        ("loops:>0", [1, 2, 11, 12]),
        ("memory:stm", [11, 12]),
        ("session:1", []),
        ("label:", [1]),
        # Stamps are 101 s to 112 s after 1970 began.
        ("stamp:103..104.5", [3, 4]),
        ("time:00:01:44", [4]),
        ("time:00:01:44..00:01:46", [4, 5, 6]),
        ("time:00:01 id:2..3", [2, 3]),
        ("time:1970-01-01", list(range(1, NODES + 1))),
        ("time:1970-01-01T00:01:50..", [10, 11, 12]),
        ("time:>1970-01-01", []),
    ],
)
def test_each_property_finds_its_nodes(found: Found, query: str, ids: list[int]) -> None:
    assert found(query) == ids


@pytest.mark.parametrize("query", ["near {x:.3f} {y:.3f} 0.4", "near:{x:.3f},{y:.3f},0.4", "NEAR #4 0.4 "])
def test_a_place_finds_what_is_within_the_radius(snapshot: Snapshot, found: Found, query: str) -> None:
    x, y = snapshot.poses[4][:2, 3]
    near = [i for i in snapshot.nodes.ids.tolist() if np.hypot(*(snapshot.poses[i][:2, 3] - (x, y))) <= 0.4]
    assert 4 in near and len(near) < NODES
    assert found(query.format(x=x, y=y)) == near
    assert found(f"id:5.. {query.format(x=x, y=y)}") == [i for i in near if i >= 5], "all parts must hold"


@given(st.integers(-5, 20), st.integers(-5, 20))
def test_a_range_is_both_its_comparisons(found: Found, least: int, most: int) -> None:
    assert found(f"id:{least}..{most}") == found(f"id:>={least} id:<={most}")
    assert found(f"id:{least}..") == sorted({*range(1, NODES + 1)} - set(found(f"id:<{least}")))


@pytest.mark.parametrize(
    ("query", "part"),
    [
        ("room:2", "id:, label:"),
        ("id:abc", "id:100..200"),
        ("id:..", "id:100..200"),
        ("time:25:00", "time:10:15"),
        ("time:yesterday", "time:10:15"),
        ("memory:short", "memory:stm"),
        ("near #99", "no node 99"),
        ("near 1 2 -3", "above 0"),
        ("stamp:", "nothing is not understood"),
        ("near 1", "needs a place"),
    ],
)
def test_what_is_not_understood_says_what_would_be(found: Found, query: str, part: str) -> None:
    with pytest.raises(QueryError, match=part):
        found(query)


def test_words_are_found_in_labels_whatever_their_case(snapshot: Snapshot) -> None:
    labels = ("Door", "door 2", *[None] * (NODES - 2))
    table = replace(snapshot.nodes, labels=labels)
    assert matching(snapshot, table, "door").tolist() == [True, True, *[False] * (NODES - 2)]
    assert matching(snapshot, table, "label:DOOR 2").tolist() == [False, True, *[False] * (NODES - 2)]
    assert matching(snapshot, table, "label:").sum() == 2
