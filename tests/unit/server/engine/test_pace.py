"""A run goes at the speed that was asked for."""

from __future__ import annotations

import time

import pytest

from server.engine.pace import Pace


def test_as_fast_as_possible_never_waits() -> None:
    assert [Pace(0.0).wait_for(stamp) for stamp in (0.0, 100.0)] == [0.0, 0.0]


@pytest.mark.parametrize("speed", [0.5, 1.0, 10.0])
def test_the_first_frame_is_due_at_once_and_the_others_by_their_stamps(speed: float) -> None:
    pace = Pace(speed)
    assert pace.wait_for(1000.0) == 0.0
    assert pace.wait_for(1002.0) == pytest.approx(2.0 / speed, abs=0.05)


def test_time_lost_is_not_made_up_in_a_hurry() -> None:
    pace = Pace(1.0)
    pace.wait_for(0.0)
    time.sleep(0.7)
    assert pace.wait_for(0.1) == 0.0
    assert pace.wait_for(0.2) == pytest.approx(0.1, abs=0.05)


def test_after_a_pause_the_next_frame_is_due_at_once() -> None:
    pace = Pace(1.0)
    pace.wait_for(0.0)
    pace.restart()
    assert pace.wait_for(50.0) == 0.0
