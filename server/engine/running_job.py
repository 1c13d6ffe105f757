"""A job under way in an engine's process: one step at a time, so that requests are heard between them."""

from __future__ import annotations

import time
from collections import deque

from server.engine.channel import Channel
from server.engine.events import JobTold
from slam.edit.job import Job
from slam.effect import Effect
from slam.errors import SlamError

_TOLD_SECONDS = 0.2


class RunningJob:
    """Carries out a job and tells how it is.

    Attributes:
        number: by which its events name it.
        is_over: whether it has ended.
        effect: on the map, once it has ended well.
    """

    def __init__(self, number: int, job: Job, channel: Channel) -> None:
        self.number = number
        self.is_over = False
        self.effect: Effect | None = None
        self._job = job
        self._channel = channel
        self._share = 0.0
        self._told = 0.0
        self._lines: deque[str] = deque()

    def step(self) -> None:
        """Do some more of it."""
        try:
            step = next(self._job)
        except StopIteration as end:
            self.effect = end.value
            self._end(JobTold(self.number, "done", 1.0, tuple(self._lines), effect=self.effect))
            return
        except SlamError as error:
            self._end(JobTold(self.number, "failed", self._share, tuple(self._lines), error=error))
            return
        self._share = step.share
        if step.text:
            self._lines.append(step.text)
        if time.monotonic() - self._told > _TOLD_SECONDS:
            self._told = time.monotonic()
            self._channel.send(JobTold(self.number, "running", self._share, tuple(self._lines)))
            self._lines.clear()

    def cancel(self) -> None:
        """Stop it; the map is as it was before it began."""
        self._job.close()
        self._end(JobTold(self.number, "cancelled", self._share, tuple(self._lines)))

    def _end(self, event: JobTold) -> None:
        self.is_over = True
        self._lines.clear()
        self._channel.send(event)
