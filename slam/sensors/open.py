"""One address for every kind of source."""

from __future__ import annotations

from pathlib import Path

from slam.sensors.source import Source
from slam.sensors.tum import TumFolder


def open_source(url: str | Path) -> Source:
    """The source of an address: a TUM folder.

    Raises:
        SourceError: the address can't be used; whatever can be checked before the first frame is checked here.
    """
    return TumFolder(Path(url))
