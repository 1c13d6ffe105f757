"""Long work on a map, step by step, so that whoever carries it out can tell how far it is, and stop it."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

from slam.effect import Effect


@dataclass(frozen=True, slots=True)
class JobStep:
    """How far a job is: the share that is done, 0 to 1, and a line for its log, if there is something to say."""

    share: float
    text: str = ""


#: Yields steps; returns what it did, None where there was nothing to do. Closed before its end, it has changed nothing.
Job = Generator[JobStep, None, Effect | None]
