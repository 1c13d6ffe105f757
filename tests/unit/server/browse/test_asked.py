"""Who waits for an answer is let pass, unless the answer is long work."""

from __future__ import annotations

import pytest

from server.browse.asked import Asked


class Clock:
    """Says what it is told."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def test_a_request_is_urgent_while_it_is_answered() -> None:
    asked = Asked(Clock())
    assert not asked.is_urgent
    with asked.one():
        with asked.one():
            assert asked.is_urgent
        assert asked.is_urgent
    assert not asked.is_urgent


def test_one_that_failed_waits_no_longer() -> None:
    asked = Asked(Clock())
    with pytest.raises(ValueError, match="gone"), asked.one():
        raise ValueError("gone")
    assert not asked.is_urgent


def test_long_work_holds_up_nothing_else() -> None:
    clock = Clock()
    asked = Asked(clock)
    with asked.one():
        clock.now = 1.9
        assert asked.is_urgent
        clock.now = 2.1
        assert not asked.is_urgent
        with asked.one():
            assert asked.is_urgent
