"""One address for every kind of source."""

from __future__ import annotations

from pathlib import Path

from slam.sensors.source import Source
from slam.sensors.tour.options import TourOptions
from slam.sensors.tour.tour import Tour
from slam.sensors.tum import TumFolder

TOUR = "tour:"


def open_source(url: str | Path) -> Source:
    """The source of an address: ``tour:`` with options (``tour:laps=2,fps=15``), else a TUM folder.

    Raises:
        SourceError: the address can't be used; whatever can be checked before the first frame is checked here.
    """
    text = str(url)
    if text.startswith(TOUR):
        return Tour(TourOptions.parse(text.removeprefix(TOUR)))
    return TumFolder(Path(text))
