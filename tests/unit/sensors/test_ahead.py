"""Work done ahead by one thread, without anybody noticing."""

from __future__ import annotations

import threading
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from slam.sensors.ahead import DEPTH, ahead


@given(st.integers(0, 20))
def test_all_items_in_order(count: int) -> None:
    assert list(ahead(count, lambda index: index * index)) == [index * index for index in range(count)]


@given(st.integers(0, 8))
def test_an_error_comes_at_its_place(bad: int) -> None:
    def load(index: int) -> int:
        if index >= bad:
            raise KeyError(index)
        return index

    seen = []
    with pytest.raises(KeyError, match=str(bad)):
        for item in ahead(10, load):
            seen.append(item)
    assert seen == list(range(bad))


def test_the_next_items_are_made_meanwhile_and_no_more() -> None:
    made: list[int] = []

    def load(index: int) -> int:
        made.append(index)
        return index

    items = ahead(100, load)
    next(items)
    deadline = time.monotonic() + 5
    while len(made) < DEPTH + 1 and time.monotonic() < deadline:
        time.sleep(0.01)
    time.sleep(0.05)
    assert made == list(range(DEPTH + 1))
    items.close()


def test_leaving_early_ends_the_thread() -> None:
    before = threading.active_count()
    for item in ahead(1000, lambda index: index):
        if item == 3:
            break
    deadline = time.monotonic() + 5
    while threading.active_count() > before and time.monotonic() < deadline:
        time.sleep(0.01)
    assert threading.active_count() == before


def test_leaving_early_drops_what_was_not_begun() -> None:
    begun: list[int] = []

    def load(index: int) -> int:
        begun.append(index)
        time.sleep(0.05)
        return index

    items = ahead(100, load)
    next(items)
    items.close()
    count = len(begun)
    time.sleep(0.3)
    assert len(begun) == count
