"""Features extracted ahead are those that would be extracted now."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from slam.camera import Camera
from slam.errors import SourceError
from slam.features.extract import Extractor
from slam.features.prepared import PreparedExtractor
from slam.params import Params
from slam.run import prepared
from slam.slam import Slam
from slam.types import Frame
from tests.tours import dense

PARAMS = Params()


class Recorded:
    """A source of given frames, of which the one at ``broken`` can't be read."""

    live = False
    name = "recorded"

    def __init__(self, frames: tuple[Frame, ...], broken: int = -1) -> None:
        self._frames, self._broken = frames, broken

    @property
    def camera(self) -> Camera:
        return self._frames[0].camera

    def __len__(self) -> int:
        return len(self._frames)

    def __iter__(self) -> Iterator[Frame]:
        for index, frame in enumerate(self._frames):
            if index == self._broken:
                raise SourceError("frame 3 can't be read")
            yield frame


@pytest.fixture
def frames() -> tuple[Frame, ...]:
    return tuple(dense()[:6])


def test_prepared_features_are_the_same(frames: tuple[Frame, ...]) -> None:
    extractor, now = PreparedExtractor(), Extractor()
    worker = threading.Thread(target=extractor.prepare, args=(frames[1], PARAMS))
    worker.start()
    worker.join()
    for frame in frames[:2]:
        found, expected = extractor.extract(frame, PARAMS), now.extract(frame, PARAMS)
        np.testing.assert_array_equal(found.features.pixels, expected.pixels)
        np.testing.assert_array_equal(found.features.descriptors, expected.descriptors)
        assert found.time_ms > 0


def test_what_was_prepared_by_other_parameters_or_of_another_frame_is_not_taken(frames: tuple[Frame, ...]) -> None:
    extractor, few = PreparedExtractor(), PARAMS.changed({"Vis/MaxFeatures": 50})
    extractor.prepare(frames[0], PARAMS)
    assert len(extractor.extract(frames[0], few).features) == 50
    extractor.prepare(frames[0], PARAMS)
    black = replace(frames[0], image_bgr=np.zeros_like(frames[0].image_bgr))
    assert len(extractor.extract(black, PARAMS).features) == 0


def test_a_prepared_run_is_the_same_bit_for_bit(frames: tuple[Frame, ...]) -> None:
    plain, ahead = Slam(PARAMS), Slam(PARAMS)
    for frame in frames:
        plain.process(frame)
    for frame in prepared(Recorded(frames), ahead):
        ahead.process(frame)
    for a, b in zip(plain.frames, ahead.frames, strict=True):
        assert a.T_node_base is not None
        assert b.T_node_base is not None
        np.testing.assert_array_equal(a.T_node_base, b.T_node_base)


def test_a_frame_that_cannot_be_read_raises_in_its_turn(frames: tuple[Frame, ...]) -> None:
    seen = []
    with pytest.raises(SourceError, match="frame 3"):
        for frame in prepared(Recorded(frames, broken=3), Slam(PARAMS)):
            seen.append(frame.index)
    assert seen == [frame.index for frame in frames[:3]]


def test_whoever_stops_leaves_no_thread(frames: tuple[Frame, ...]) -> None:
    for _ in prepared(Recorded(frames), Slam(PARAMS)):
        break
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("features")]
