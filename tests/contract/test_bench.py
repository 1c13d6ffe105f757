"""The table of `make bench` says what was measured, and whether it is what is wanted."""

from __future__ import annotations

from typing import Any

from tests.bench.figures import figures
from tests.bench.page import page, table

SUMMARY: dict[str, Any] = {
    "frames": 373,
    "lost_frames": 4,
    "ate_rmse_m": 0.0431,
    "loops": {"global": 5, "proximity": 2, "refused": 9},
    "fps": 61.5,
    "median_ms": {"odometry": 15.0, "update": 30.0},
    "odometry_alone_ms": 11.0,
    "peak_rss_mb": 420.0,
}


def result() -> dict[str, Any]:
    works = {"optimise 800 poses with 10 % loops from odometry, ms": 16.0, "import of the engine, s": 1.2}
    found = figures({"hololens_tour": SUMMARY}, {"update_ms_wm_300": 44.0}, works)
    machine = {"cores": 2, "load": 0.1, "python": "3.11", "system": "x86_64"}
    rows = [figure._asdict() for figure in found]
    return {"commit": "abc1234", "date": "2026-01-01", "machine": machine, "reference_ms": 4.5, "figures": rows}


def test_every_figure_says_whether_it_is_met() -> None:
    met = {row["name"]: row["met"] for row in result()["figures"]}
    assert met["hololens_tour: ATE"] is True
    assert met["hololens_tour: frames tracked of 373"] is False, "369 of at least 370"
    assert met["hololens_tour: whole pipeline on 2 cores"] is True
    assert met["hololens_tour: odometry per frame, alone"] is True
    assert met["hololens_tour: resident memory, peak"] is False
    assert met["map update with node, WM 300, 500 words"] is False
    assert met["optimise 800 poses with 10 % loops from odometry"] is True
    assert met["import of the engine"] is None


def test_the_page_has_the_commit_the_reference_and_every_row_of_the_table() -> None:
    text, lines = page(result()), table(result())
    assert "abc1234" in text
    assert "| reference: features of a fixed 640x480 image | 4.5 | ms |" in text
    assert "| hololens_tour: ATE | 4.31 | cm | 7.6 cm | <= 5 | met |" in text
    assert len(lines) == len(result()["figures"]) + 2
