"""Small pieces of work, timed within this process."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from slam.camera import Camera
from slam.features.extract import Extractor
from slam.geometry import between
from slam.graph import PoseGraph, optimize
from slam.params import Params
from slam.types import Frame, Link, LinkType
from tests.graphs import INFORMATION, LAP, circles, loop, noisy, truth

_ROOT = Path(__file__).resolve().parents[2]
_POSES, _LOOPS = 800, 80


def reference_ms() -> float:
    """Median time of feature extraction on a fixed 640x480 image."""
    noise = np.random.default_rng(0).integers(0, 255, (60, 80, 3)).astype(np.uint8)
    image = np.kron(noise, np.ones((8, 8, 1), np.uint8))
    depth = np.full((480, 640), 2.0, np.float32)
    frame = Frame(0, 0.0, image, depth, Camera(640, 480, 525.0, 525.0, 319.5, 239.5))
    extractor, params = Extractor(), Params()
    return _median_ms(lambda: extractor.extract(frame, params), 30)


def optimisations() -> dict[str, float]:
    """Median times of optimising a graph of 800 poses with 10 % loops."""
    graph, params = circles(_POSES, _LOOPS), Params()
    new = iter([circles(_POSES, _LOOPS, seed=seed) for seed in range(8)])
    return {
        "optimise 800 poses with 10 % loops from odometry, ms": _median_ms(lambda: optimize(graph, params), 9),
        "the same, of a graph that was never seen, ms": _median_ms(lambda: optimize(next(new), params), 7),
        "the same, of the last result with one more loop, ms": _growing_ms(params),
    }


def seconds(statement: str) -> float:
    """Time of a new Python that carries out one statement."""
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", statement], check=True, cwd=_ROOT)
    return round(time.perf_counter() - start, 2)


def _growing_ms(params: Params) -> float:
    graph, rng, true = circles(_POSES, _LOOPS), np.random.default_rng(1), truth(_POSES + 10)
    graph.poses = optimize(graph, params).poses

    def grow() -> None:
        graph.poses = optimize(graph, params).poses

    return round(float(np.median([_grown(graph, rng, true, grow) for _ in range(9)])), 2)


def _grown(graph: PoseGraph, rng: np.random.Generator, true: list[np.ndarray], work: Callable[[], None]) -> float:
    """Adds a node with a loop, and times what follows."""
    last, new = graph.newest, graph.newest + 1
    step = noisy(between(true[last - 1], true[last]), rng, 1.0)
    graph.add_node(new, 0, graph.T_odom[last] @ step, graph.poses[last] @ step)
    graph.add_link(Link(last, new, LinkType.NEIGHBOR, step, INFORMATION))
    graph.add_link(loop(new, new - LAP, true, rng))
    start = time.perf_counter()
    work()
    return (time.perf_counter() - start) * 1e3


def _median_ms(work: Callable[[], object], times: int) -> float:
    work()
    spent = []
    for _ in range(times):
        start = time.perf_counter()
        work()
        spent.append((time.perf_counter() - start) * 1e3)
    return round(float(np.median(spent)), 2)
