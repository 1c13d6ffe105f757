"""What may change while the engine runs, and what may not."""

from __future__ import annotations

from dataclasses import replace
from itertools import count, islice

import numpy as np
import pytest

from slam.errors import ParameterError
from slam.params import Effect, ParamSpec, Value, specs
from slam.slam import Slam
from tests.tours import EVERY, fed, sparse, there_and_back


#: Statistics that RTAB-Map does not have: its users see them as somebody's own.
@pytest.mark.parametrize("name", [spec.name for spec in specs() if spec.effect is not Effect.LIVE])
def test_what_belongs_to_a_session_does_not_change_in_it(name: str) -> None:
    slam = Slam(EVERY)
    before = slam.params
    with pytest.raises(ParameterError, match="next session"):
        slam.set_params({"Rtabmap/LoopThr": 0.5, name: slam.params.get(name)})
    assert slam.params is before


def test_a_change_that_is_not_allowed_changes_nothing() -> None:
    slam = Slam(EVERY)
    for changes in ({"Rtabmap/LoopThr": 2.0}, {"Rtabmap/LoopThr": 0.5, "Mem/STMSize": 0}, {"Rtabmap/Nothing": 1}):
        with pytest.raises(ParameterError):
            slam.set_params(changes)
        assert slam.params is EVERY


def test_no_value_within_its_bounds_stops_the_engine() -> None:
    slam, way = Slam(EVERY.changed({"Rtabmap/MemoryThr": 8})), there_and_back(16)
    usual = slam.params
    frames = (replace(way[k % 30], index=k, stamp=way[0].stamp + 0.5 * k) for k in count())
    fed(slam, islice(frames, 20))
    for entry in specs():
        for value in extremes(entry):
            slam.set_params({entry.name: value})
            slam.process(next(frames))
            slam.set_params({entry.name: usual.get(entry.name)})
    assert all(np.isfinite(T).all() for T in slam.graph.poses.values())


def extremes(entry: ParamSpec) -> list[Value]:
    """The least and the largest value of a live parameter; ten times the default where there is no bound."""
    if entry.effect is not Effect.LIVE:
        return []
    if isinstance(entry.default, bool):
        return [not entry.default]
    if isinstance(entry.default, str):
        return ["0.4 0.5 0.45 0.5"] if entry.name.endswith("RoiRatios") else list(entry.choices)
    far = max(10, 10 * entry.default)
    bounds = (-far if entry.minimum is None else entry.minimum, far if entry.maximum is None else entry.maximum)
    return [type(entry.default)(bound) for bound in bounds]


def test_a_smaller_short_term_memory_empties_at_the_next_node() -> None:
    slam = Slam(EVERY)
    fed(slam, sparse()[:8])
    slam.set_params({"Mem/STMSize": 2})
    fed(slam, sparse()[8:9])
    assert list(slam.memory.stm) == [8, 9]
    assert list(slam.memory.wm) == list(range(1, 8))


# Losing track, and beginning anew.
