"""One sequence, mapped in a process of its own, so that the peak memory is its own.

``python -m tests.bench.sequence SOURCE [Group/Name=value ...]`` prints what was measured as JSON.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from slam.database import MapWriter
from slam.odometry.strategy import make_tracker
from slam.params import Params
from slam.run import run
from slam.sensors import open_source
from slam.slam import Slam
from slam.types import Update

SEQUENCES = ("tum_fr1_xyz_excerpt", "toyroom", "hololens_tour")
#: Updates whose working memory lies within count as those of 300 nodes.
_AROUND_300 = (270, 330)
#: Frames by which odometry is timed alone.
_ALONE = 100
_ROOT = Path(__file__).resolve().parents[2]


def measured(source: str, *changes: str) -> dict[str, Any]:
    """Summary of a run in a new process, with the times of updates around 300 nodes in working memory."""
    command = [sys.executable, "-m", "tests.bench.sequence", source, *changes]
    said = subprocess.run(command, check=True, cwd=_ROOT, stdout=subprocess.PIPE, text=True)
    found: dict[str, Any] = json.loads(said.stdout)
    return found


def main() -> None:
    """Maps the source of the first argument with the parameters of the others, on two cores."""
    source, *changes = sys.argv[1:]
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:2])
    params = Params().changed(dict(change.split("=", 1) for change in changes))
    times: list[tuple[float, float]] = []

    def on_update(update: Update) -> None:
        if update.node is not None:
            times.append((update.statistics.get("Memory/Working_memory_size/", 0.0), update.time_ms))

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bench.db"
        slam = Slam(params, MapWriter.create(path, params, seed=0, source=source))
        tally = run(open_source(source), slam, on_update)
        slam.close()
        summary = tally.summary(slam, seed=0, path=path)
    summary["peak_rss_mb"] = _peak_mb() or summary["peak_rss_mb"]
    summary["odometry_alone_ms"] = _odometry_alone_ms(source, params)
    around = [ms for size, ms in times if _AROUND_300[0] <= size <= _AROUND_300[1]]
    summary["update_ms_wm_300"] = round(float(np.median(around)), 2) if around else None
    print(json.dumps(summary))


def _odometry_alone_ms(source: str, params: Params) -> float:
    """Median time of tracking a frame, features included, with nothing else at work."""
    tracker = make_tracker(params)
    frames = list(islice(open_source(source), _ALONE))
    return round(float(np.median([tracker.track(frame, params).time_ms for frame in frames])), 2)


def _peak_mb() -> float | None:
    """Peak of this program alone; what the kernel counts for the process may hold that of its parent before it."""
    status = Path("/proc/self/status")
    if not status.exists():
        return None
    peak = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM:"))
    return round(int(peak.split()[1]) * 1024 / 1e6, 1)


if __name__ == "__main__":
    main()
