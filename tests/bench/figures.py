"""The figures to reach, beside what was measured."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple


class Figure(NamedTuple):
    """One line of the table: what, how much of what unit, what the peers reach, what is wanted, whether it is met."""

    name: str
    value: float | str | None
    unit: str
    peers: str = ""
    target: str = ""
    met: bool | None = None


#: Absolute trajectory errors: of the peers in words, and the target in centimetres.
_ATE = {
    "tum_fr1_xyz_excerpt": ("1.1 cm", 0.9),
    "toyroom": ("1.4 cm", 0.6),
    "hololens_tour": ("7.6 cm", 5.0),
}
_TRACKED = 370
_MEMORY_MB = 400.0
_ODOMETRY_MS, _UPDATE_MS, _OPTIMISE_MS, _FPS = 12.0, 40.0, 20.0, 60.0

Summaries = Mapping[str, Mapping[str, Any]]


def figures(sequences: Summaries, full: Mapping[str, Any] | None, works: Mapping[str, float]) -> list[Figure]:
    """All figures of one measurement.

    Args:
        sequences: name -> summary of its run with default parameters.
        full: summary of the run that makes every frame a node, None without its data.
        works: name with unit -> value of the small pieces of work.
    """
    found: list[Figure] = []
    for name, summary in sequences.items():
        found += _accuracy(name, summary)
    for name, summary in sequences.items():
        found += _pace(name, summary)
    wm_300 = None if full is None else full["update_ms_wm_300"]
    if wm_300 is not None:
        found.append(most("map update with node, WM 300, 500 words", wm_300, "ms", "30 to 60", _UPDATE_MS))
    for name, value in works.items():
        text, _, unit = name.rpartition(", ")
        wanted = text.startswith("optimise 800")
        found.append(most(text, value, unit, "77", _OPTIMISE_MS) if wanted else Figure(text, value, unit))
    return found


def _accuracy(name: str, summary: Mapping[str, Any]) -> list[Figure]:
    ate, tracked, rows = summary["ate_rmse_m"], summary["frames"] - summary["lost_frames"], list[Figure]()
    if ate is not None:
        peers, target = _ATE.get(name, ("", None))
        rows.append(most(f"{name}: ATE", round(100 * ate, 3), "cm", peers, target))
    wanted = name == "hololens_tour"
    rows.append(
        Figure(
            f"{name}: frames tracked of {summary['frames']}",
            tracked,
            "frames",
            "330 to 370" if wanted else "",
            f">= {_TRACKED}" if wanted else "",
            tracked >= _TRACKED if wanted else None,
        )
    )
    loops = summary["loops"]
    rows.append(Figure(f"{name}: loops", f"{loops['global']} global, {loops['proximity']} proximity", ""))
    return rows


def _pace(name: str, summary: Mapping[str, Any]) -> list[Figure]:
    fps, median = summary["fps"], summary["median_ms"]
    limit = _MEMORY_MB if name == "hololens_tour" else None
    return [
        Figure(f"{name}: whole pipeline on 2 cores", fps, "frames/s", "about 20", f">= {_FPS:g}", fps >= _FPS),
        most(f"{name}: odometry per frame, alone", summary["odometry_alone_ms"], "ms", "15 to 37", _ODOMETRY_MS),
        Figure(f"{name}: odometry per frame, in the pipeline", median["odometry"], "ms"),
        Figure(f"{name}: map update with node, median", median["update"], "ms"),
        most(f"{name}: resident memory, peak", summary["peak_rss_mb"], "MB", "260" if limit else "", limit),
    ]


def most(name: str, value: float, unit: str, peers: str, limit: float | None) -> Figure:
    """A figure that is met at or below a limit."""
    if limit is None:
        return Figure(name, value, unit, peers)
    return Figure(name, value, unit, peers, f"<= {limit:g}", value <= limit)
