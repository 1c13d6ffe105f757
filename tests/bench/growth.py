"""``python -m tests.bench.growth [nodes] [NAME=VALUE ...]``: what an update costs as the map grows.

Times of the processor stand beside those of the clock, which a busy machine spoils; making up the frame is in both.
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
    with tempfile.TemporaryDirectory() as folder:
        slam = Slam(params, MapWriter.create(Path(folder) / "m.db", params, seed=0, source="ghosts"), source="ghosts")
        slam._odometry = GhostOdometry(world)  # type: ignore[assignment]
        block: list[Update] = []
        spent: list[float] = []
        print(" nodes   wm    ltm  links  cpu ms  median    p95    max ms  loops  dearest stages, median ms")
        for frame in world.frames(count):
            start = time.process_time()
            block.append(slam.process(frame))
            spent.append(1e3 * (time.process_time() - start))
            if len(block) == _BLOCK:
                print(_line(slam, block, float(np.median(spent))), flush=True)
                block, spent = [], []
        slam.close()
        error = ate_rmse_m(slam)
    print(f"trajectory error {100 * (error or 0):.1f} cm after closing")


def _line(slam: Slam, block: list[Update], cpu_ms: float) -> str:
    times = np.array([update.time_ms for update in block])
    loops = sum(candidate.refusal is None for update in block for candidate in update.candidates)
    stages = Counter[str]()
    for name in {n for update in block for n in update.statistics if n.startswith("Timing") and "Total" not in n}:
        stages[name] = float(np.median([update.statistics.get(name, 0.0) for update in block]))
    stages["write"] = float(np.median([update.time_ms - update.statistics["Timing/Total/ms"] for update in block]))
    dear = ", ".join(f"{name.split('/')[-2] if '/' in name else name} {ms:.1f}" for name, ms in stages.most_common(6))
    memory = slam.memory
    return (
        f"{len(slam.graph):6d} {len(memory.wm):4d} {len(memory.ltm):6d} {len(slam.graph.links):6d} "
        f"{cpu_ms:7.1f} {np.median(times):7.1f} {np.percentile(times, 95):6.1f} {times.max():9.1f} {loops:6d}  {dear}"
    )


if __name__ == "__main__":
    main()
