"""A whole run over a source, and what is said of it at the end."""

from __future__ import annotations

import resource
import sys
import time
from collections import Counter, deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from slam.errors import SourceError
from slam.sensors import Source
from slam.slam import Slam
from slam.types import Frame, LinkType, Update

OnUpdate = Callable[[Update], None]


class Tally:
    """Counts and times the updates of a run."""

    def __init__(self) -> None:
        self._start = time.perf_counter()
        self._odometry_ms: list[float] = []
        self._update_ms: list[float] = []
        self._loops: Counter[str] = Counter(dict.fromkeys(("global", "proximity", "refused"), 0))
        self.lost_frames = 0

    @property
    def frames(self) -> int:
        """Frames so far."""
        return len(self._odometry_ms)

    def add(self, update: Update) -> None:
        """Takes in one update."""
        self._odometry_ms.append(update.odometry.time_ms)
        self.lost_frames += update.T_map_base is None
        if update.time_ms:
            self._update_ms.append(update.time_ms)
        for candidate in update.candidates:
            kind = "global" if candidate.type is LinkType.GLOBAL_CLOSURE else "proximity"
            self._loops[kind if candidate.refusal is None else "refused"] += 1

    def summary(self, slam: Slam, *, seed: int, path: Path | None) -> dict[str, Any]:
        """The object that ``slamdeck run --json`` prints; times in milliseconds, sizes in megabytes."""
        seconds = time.perf_counter() - self._start
        graph = slam.graph
        links = Counter(link.type.label for link in (*graph.links.values(), *graph.constraints.values()))
        return {
            "frames": self.frames,
            "nodes": len(slam.graph),
            "links": dict(sorted(links.items())),
            "loops": dict(self._loops),
            "ate_rmse_m": ate_rmse_m(slam),
            "lost_frames": self.lost_frames,
            "fps": round(self.frames / seconds, 2),
            "median_ms": {"odometry": _median(self._odometry_ms), "update": _median(self._update_ms)},
            "peak_rss_mb": round(peak_rss_mb(), 1),
            "db_mb": None if path is None else round(path.stat().st_size / 1e6, 3),
            "seed": seed,
            **({"localization": self._localization(slam)} if not slam.params.Mem.IncrementalMemory else {}),
        }

    def _localization(self, slam: Slam) -> dict[str, Any]:
        """How many frames were localised, from which on, and how long it took to be localised again, in frames."""
        known = [frame.T_node_base is not None for frame in slam.frames]
        gaps = "".join("x" if one else "." for one in known).split("x")
        return {
            "localized_frames": sum(known),
            "first_localized_frame": known.index(True) if any(known) else None,
            "longest_gap_frames": max((len(gap) for gap in gaps), default=0),
        }


def prepared(source: Source, slam: Slam) -> Iterator[Frame]:
    """Frames of a source, each prepared by a second thread while the one before is processed.

    A frame that can't be read raises in its turn. A live source's frames come as they are: waiting for the next one
    would make each late.
    """
    if source.live:
        yield from source
        return
    worker = ThreadPoolExecutor(max_workers=1, thread_name_prefix="features")
    frames, waiting, failure = iter(source), deque[tuple[Frame, Future[None]]](), None
    try:
        while failure is None:
            try:
                frame = next(frames)
            except (StopIteration, SourceError) as end:
                failure = end
            else:
                waiting.append((frame, worker.submit(slam.prepare, frame)))
            while len(waiting) > (1 if failure is None else 0):
                ready, done = waiting.popleft()
                done.result()
                yield ready
    finally:
        worker.shutdown(wait=True, cancel_futures=True)
    if isinstance(failure, SourceError):
        raise failure


def run(source: Source, slam: Slam, on_update: OnUpdate) -> Tally:
    """Processes every frame of a source; ``on_update`` is called after each."""
    tally = Tally()
    for frame in prepared(source, slam):
        update = slam.process(frame)
        tally.add(update)
        on_update(update)
    return tally


def ate_rmse_m(slam: Slam) -> float | None:
    """Absolute trajectory error of all tracked frames, SE(3)-aligned, metres; None without ground truth."""
    return slam.ate_m()


def peak_rss_mb() -> float:
    """Largest resident size of this process so far, megabytes."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 1e6 if sys.platform == "darwin" else peak * 1024 / 1e6


def _median(values: list[float]) -> float | None:
    return round(float(np.median(values)), 2) if values else None
