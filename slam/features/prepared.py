"""Features that another thread extracts before they are asked for."""

from __future__ import annotations

import time
from dataclasses import dataclass
from threading import Lock

from slam.features.extract import Extractor
from slam.params import Params
from slam.types import Features, Frame


@dataclass(frozen=True, slots=True, eq=False)
class Extracted:
    """Features of a frame, by these parameters, and how long they took."""

    frame: Frame
    params: Params
    features: Features
    time_ms: float


class PreparedExtractor:
    """An extractor that may be told in advance what comes; the features are the same either way."""

    def __init__(self) -> None:
        self._extractor = Extractor()
        self._lock = Lock()
        self._ready: dict[int, Extracted] = {}

    def prepare(self, frame: Frame, params: Params) -> None:
        """Extract the features of a frame that will be asked for; from any thread."""
        self._ready[frame.index] = self._extract(frame, params)

    def extract(self, frame: Frame, params: Params) -> Extracted:
        """Features of a frame; extracted now where they weren't yet, or by other parameters."""
        found = self._ready.pop(frame.index, None)
        if found is not None and found.frame is frame and found.params is params:
            return found
        return self._extract(frame, params)

    def _extract(self, frame: Frame, params: Params) -> Extracted:
        with self._lock:
            start = time.perf_counter()
            features = self._extractor.extract(frame, params)
            return Extracted(frame, params, features, (time.perf_counter() - start) * 1e3)
