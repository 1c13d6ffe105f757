"""Options of the tour, as text."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from slam.errors import SourceError
from slam.sensors.tour.options import TourOptions

options = st.builds(
    TourOptions,
    laps=st.integers(1, 20),
    fps=st.integers(1, 60).map(float),
    seed=st.integers(0, 1000),
    width=st.integers(64, 1920),
    height=st.integers(48, 1440),
    frames=st.integers(0, 5000).filter(lambda n: n != 0) | st.just(0),
    speed=st.sampled_from([0.2, 0.8, 1.0, 1.5]),
)


@given(options)
def test_the_text_of_options_gives_them_back(given_options: TourOptions) -> None:
    assert TourOptions.parse(str(given_options).removeprefix("tour:")) == given_options


def test_nothing_said_is_two_laps_at_15_fps() -> None:
    assert TourOptions.parse("") == TourOptions(2, 15.0, 0, 640, 480, 0, 0.8)
    assert TourOptions.parse(" laps = 3 , seed=7") == TourOptions(laps=3, seed=7)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("lap=2", "tour:lap=2: no option 'lap'; there are laps, fps, seed"),
        ("laps", "laps is ''; expected a whole number from 1 to 20"),
        ("laps=two", "laps is 'two'; expected a whole number"),
        ("laps=1.5", "laps is '1.5'; expected a whole number"),
        ("laps=21", "laps is '21'; expected a whole number from 1 to 20"),
        ("fps=nan", "fps is 'nan'; expected a number from 1 to 60"),
        ("fps=0", "fps is '0'; expected a number from 1 to 60"),
        ("width=10", "width is '10'; expected a whole number from 64"),
        ("seed=-1", "seed is '-1'; expected"),
        ("laps=1,laps=2", "laps is given twice"),
    ],
)
def test_bad_options_are_refused(text: str, message: str) -> None:
    with pytest.raises(SourceError, match=message):
        TourOptions.parse(text)
