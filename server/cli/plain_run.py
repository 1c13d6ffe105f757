"""A run in this process, with a progress bar."""

from __future__ import annotations

import signal
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from server.cli.progress import progress
from server.engine.mapping import engine_on_map, session_params
from slam.errors import SlamError, SourceError
from slam.params import Value
from slam.run import Tally, prepared
from slam.sensors import Source, open_source
from slam.slam import Slam
from slam.types import Frame


class StoppedError(SlamError):
    """Somebody ended the run."""


def plain_run(
    source_url: str, path: Path, values: Mapping[str, Value], *, seed: int, overwrite: bool, append: bool
) -> dict[str, Any]:
    """Map a source; the summary.

    Raises:
        StoppedError: by SIGINT or SIGTERM; the map holds what was mapped until then.
        SlamError: the source, a parameter or the file is refused.
    """
    source, params = open_source(source_url), session_params(path, values, append=append)
    opening = engine_on_map(path, params, seed=seed, source=source.name, overwrite=overwrite, append=append)
    tally = Tally()
    with opening as (slam, _), _signals() as stop, progress("mapping", len(source)) as advance:
        for frame in _read(source, slam, path):
            update = slam.process(frame)
            tally.add(update)
            advance(update, tally)
            if stop.asked:
                raise StoppedError(f"stopped; {_held(slam, path)}")
    return tally.summary(slam, seed=seed, path=path)


def _read(source: Source, slam: Slam, path: Path) -> Iterator[Frame]:
    """Frames of a source; one that can't be read ends the run, and what is mapped stays."""
    try:
        yield from prepared(source, slam)
    except SourceError as error:
        raise SourceError(f"{error}; {_held(slam, path)}") from error


def _held(slam: Slam, path: Path) -> str:
    how = "--overwrite to map into it again, --append to go on"
    return f"{path} holds the {len(slam.graph)} nodes mapped until then ({how})"


class _Stop:
    """Set by a signal, looked at between two frames: a frame is processed as a whole or not at all."""

    asked = False

    def ask(self, *_: object) -> None:
        self.asked = True


@contextmanager
def _signals() -> Iterator[_Stop]:
    stop = _Stop()
    before = {number: signal.signal(number, stop.ask) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
