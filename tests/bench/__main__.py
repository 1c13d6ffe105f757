"""``make bench``: a table on standard output, and the same as JSON in ``bench.json``.

The machine's own reference work (feature extraction on a fixed image) stands beside it: quote ratios within one run.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from slam.camera import Camera
from slam.database import MapWriter
from slam.features.extract import Extractor
from slam.graph.optimizer import optimize
from slam.params import Params
from slam.run import run
from slam.sensors import open_source
from slam.slam import Slam
from slam.types import Frame
from tests.graphs import circles

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT.parent / "shared" / "data"
SEQUENCES = ("tum_fr1_xyz_excerpt", "toyroom", "hololens_tour")


def main() -> None:
    """Runs every benchmark that this machine has the data for."""
    rows: dict[str, Any] = {"reference: features of a fixed 640x480 image, ms": _reference_ms()}
    rows["import of the command line, s"] = _seconds("import server.cli")
    rows["import of the server, s"] = _seconds("import server.app")
    rows["import of the engine, s"] = _seconds("import slam.slam")
    rows["optimise 800 poses with 10 % loops, ms"] = _optimise_ms()
    sources = [str(DATA / name) for name in SEQUENCES if (DATA / name).is_dir()] or ["tour:frames=300"]
    for source in sources:
        rows.update(_sequence(source))
    width = max(map(len, rows))
    for name, value in rows.items():
        print(f"{name:<{width}}  {value}")
    (ROOT / "bench.json").write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")


def _reference_ms() -> float:
    noise = np.random.default_rng(0).integers(0, 255, (60, 80, 3)).astype(np.uint8)
    image = np.kron(noise, np.ones((8, 8, 1), np.uint8))
    depth = np.full((480, 640), 2.0, np.float32)
    frame = Frame(0, 0.0, image, depth, Camera(640, 480, 525.0, 525.0, 319.5, 239.5))
    extractor, params = Extractor(), Params()
    return _median_ms(lambda: extractor.extract(frame, params), 30)


def _optimise_ms() -> float:
    graph = circles(800, 80)
    return _median_ms(lambda: optimize(graph, Params()), 7)


def _median_ms(work: Callable[[], object], times: int) -> float:
    work()
    spent = []
    for _ in range(times):
        start = time.perf_counter()
        work()
        spent.append((time.perf_counter() - start) * 1e3)
    return round(float(np.median(spent)), 2)


def _seconds(statement: str) -> float:
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", statement], check=True, cwd=ROOT)
    return round(time.perf_counter() - start, 2)


def _sequence(source: str) -> dict[str, Any]:
    name = Path(source).name
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bench.db"
        slam = Slam(Params(), MapWriter.create(path, Params(), seed=0, source=source))
        tally = run(open_source(source), slam, lambda _: None)
        slam.close()
        summary = tally.summary(slam, seed=0, path=path)
    keys = ("ate_rmse_m", "frames", "lost_frames", "fps", "loops", "peak_rss_mb")
    rows = {f"{name}: {key}": summary[key] for key in keys}
    return rows | {f"{name}: {key}, median ms": value for key, value in summary["median_ms"].items()}


if __name__ == "__main__":
    main()
