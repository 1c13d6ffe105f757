"""Measurements as tables for the terminal, and as the pages ``docs/accuracy.md`` and ``docs/workbench.md``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_COLUMNS = ("what", "measured", "unit", "best of the peers", "wanted", "")


def table(result: Mapping[str, Any]) -> list[str]:
    """Lines of text, columns aligned."""
    rows = [_COLUMNS, *_rows(result)]
    widths = [max(len(row[k]) for row in rows) for k in range(len(_COLUMNS))]
    return ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]


def page(result: Mapping[str, Any]) -> str:
    """Markdown."""
    machine = result["machine"]
    lines = [
        "# Accuracy and pace",
        "",
        f"Measured by `make bench` at commit {result['commit']} on {result['date']}: {machine['cores']} cores "
        f"({machine['system']}; load {machine['load']} from other work at the start), Python {machine['python']}, "
        "default parameters, each sequence in its own process.",
        "ATE is the RMSE of all tracked frames' positions after SE(3) alignment. Times are only good as ratios to the "
        "reference work of the same run; the peers were measured on another, idle machine with 2 cores.",
        "",
        f"| {' | '.join(_COLUMNS)} |",
        f"|{'---|' * len(_COLUMNS)}",
        *(f"| {' | '.join(row)} |" for row in _rows(result)),
    ]
    return "\n".join([*lines, ""])


def workbench_page(result: Mapping[str, Any]) -> str:
    """Markdown."""
    machine = result["machine"]
    lines = [
        "# The page's figures",
        "",
        f"Measured by `python -m tests.bench --workbench` at commit {result['commit']} on {result['date']}: a real "
        f"server and headless Chromium, which draws in software, on {machine['cores']} cores ({machine['system']}), "
        f"Python {machine['python']}.",
        "Load is that of the machine, from this and other work, when the figure was known: on two cores everything "
        "above 2 makes times longer. Times are only good as ratios to the reference work of the same run; bytes do not "
        "depend on it.",
        "",
        "| what | measured | unit | wanted | | load |",
        "|---|---|---|---|---|---|",
        f"| reference: features of a fixed 640x480 image | {result['reference_ms']} | ms | | | {machine['load']} |",
    ]
    for figure in result["figures"]:
        name, value, unit, _, wanted, verdict = _row(figure)
        lines.append(f"| {name} | {value} | {unit} | {wanted} | {verdict} | {figure['load']} |")
    return "\n".join([*lines, ""])


def _rows(result: Mapping[str, Any]) -> list[tuple[str, ...]]:
    reference = ("reference: features of a fixed 640x480 image", str(result["reference_ms"]), "ms", "", "", "")
    return [reference, *(_row(figure) for figure in result["figures"])]


def _row(figure: Mapping[str, Any]) -> tuple[str, ...]:
    verdict = {True: "met", False: "missed", None: ""}[figure["met"]]
    value = "" if figure["value"] is None else str(figure["value"])
    return (figure["name"], value, figure["unit"], figure["peers"], figure["target"], verdict)
