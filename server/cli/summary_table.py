"""The summary of a run as a table for people."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich.table import Table


def summary_table(summary: Mapping[str, Any], path: Path) -> Table:
    """One row for each thing worth knowing."""
    table = Table(show_header=False, box=None, padding=(0, 2, 0, 0))
    loops, times = summary["loops"], summary["median_ms"]
    table.add_row("map", f"{path} ({summary['db_mb']} MB)")
    table.add_row("frames", f"{summary['frames']} ({summary['lost_frames']} lost), {summary['fps']} per second")
    table.add_row("nodes", str(summary["nodes"]))
    table.add_row("links", ", ".join(f"{count} {kind}" for kind, count in summary["links"].items()))
    table.add_row("loops", f"{loops['global']} global, {loops['proximity']} proximity, {loops['refused']} refused")
    if summary["ate_rmse_m"] is not None:
        table.add_row("trajectory error", f"{100 * summary['ate_rmse_m']:.2f} cm (ATE, SE(3)-aligned)")
    table.add_row("median time", f"odometry {times['odometry']} ms, update {times['update']} ms")
    table.add_row("memory", f"{summary['peak_rss_mb']} MB at most")
    return table
