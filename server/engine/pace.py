"""The speed of a run, by the stamps of its frames."""

from __future__ import annotations

import time

#: A run that is behind by more than this gives up catching up.
_BEHIND_SECONDS = 0.5


class Pace:
    """Says how long to wait before a frame; ``speed`` is times real time, 0 never waits."""

    def __init__(self, speed: float) -> None:
        self._speed = speed
        self._origin: float | None = None

    def restart(self) -> None:
        """The next frame is due at once, and sets the time for those after it (after a pause)."""
        self._origin = None

    def wait_for(self, stamp: float) -> float:
        """Seconds until a frame is due."""
        if self._speed <= 0:
            return 0.0
        now, offset = time.monotonic(), stamp / self._speed
        if self._origin is None or now - (self._origin + offset) > _BEHIND_SECONDS:
            self._origin = now - offset
        return max(0.0, self._origin + offset - now)
