"""``python -m tests.bench.growth [nodes] [NAME=VALUE ...]``: what an update costs as the map grows.

Times are those of the processor, which other programs don't spoil; making up the frame is timed apart and not in them.
The stages are by the clock.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np

from slam.database import MapWriter
from slam.params import Params
from slam.run import ate_rmse_m
from slam.slam import Slam
from slam.types import Update
from tests.ghosts import GhostOdometry, GhostWorld

#: Nodes of one line of the table.
_BLOCK = 500


def main() -> None:
    """Prints median, 95th percentile and the dearest stages of every block of nodes."""
    arguments = sys.argv[1:]
    count = int(arguments[0]) if arguments else 10_000
    given = dict(text.split("=", 1) for text in arguments[1:])
    params = Params().changed({"Rtabmap/DetectionRate": 0.0, "Rtabmap/MemoryThr": 300, **given})
    world = GhostWorld(max(20, count // 20))
    odometry = GhostOdometry(world)
    with tempfile.TemporaryDirectory() as folder:
        slam = Slam(params, MapWriter.create(Path(folder) / "m.db", params, seed=0, source="ghosts"), source="ghosts")
        slam._odometry = odometry  # type: ignore[assignment]
        block: list[Update] = []
        spent: list[float] = []
        print(" nodes   wm    ltm  links  median    p95      max cpu ms  loops  dearest stages, median ms")
        for frame in world.frames(count):
            odometry.prepare(frame, params)
            start = time.process_time()
            block.append(slam.process(frame))
            spent.append(1e3 * (time.process_time() - start))
            if len(block) == _BLOCK:
                print(_line(slam, block, spent), flush=True)
                block, spent = [], []
        slam.close()
        error = ate_rmse_m(slam)
    print(f"trajectory error {100 * (error or 0):.1f} cm after closing")


def _line(slam: Slam, block: list[Update], spent_ms: list[float]) -> str:
    loops = sum(candidate.refusal is None for update in block for candidate in update.candidates)
    stages = Counter[str]()
    for name in {n for update in block for n in update.statistics if n.startswith("Timing") and "Total" not in n}:
        stages[name] = float(np.median([update.statistics.get(name, 0.0) for update in block]))
    stages["write"] = float(np.median([update.time_ms - update.statistics["Timing/Total/ms"] for update in block]))
    dear = ", ".join(f"{name.split('/')[-2] if '/' in name else name} {ms:.1f}" for name, ms in stages.most_common(6))
    memory = slam.memory
    return (
        f"{len(slam.graph):6d} {len(memory.wm):4d} {len(memory.ltm):6d} {len(slam.graph.links):6d} "
        f"{np.median(spent_ms):7.1f} {np.percentile(spent_ms, 95):6.1f} {max(spent_ms):15.1f} {loops:6d}  {dear}"
    )


if __name__ == "__main__":
    main()
