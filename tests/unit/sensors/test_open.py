"""One address for every source."""

from __future__ import annotations

from pathlib import Path

import pytest

from slam.errors import SourceError
from slam.sensors import open_source


def test_a_path_or_its_text_is_a_folder(folder: Path) -> None:
    assert len(open_source(folder)) == len(open_source(str(folder))) == 5


def test_the_tour_opens_before_anything_is_painted() -> None:
    source = open_source("tour:frames=7,width=320,height=240")
    assert len(source) == 7
    assert (source.camera.width, source.camera.height, source.live) == (320, 240, False)


@pytest.mark.parametrize("url", ["tour:laps=0", "tour:colour=red", "nowhere/at/all", ""])
def test_bad_addresses_are_refused(url: str) -> None:
    with pytest.raises(SourceError):
        open_source(url)
