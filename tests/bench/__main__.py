"""``make bench``: a table on standard output, and the same as JSON in ``bench.json``.

The machine's own reference work (feature extraction on a fixed image) stands beside it: quote ratios within one run.
``python -m tests.bench --workbench`` measures the page in a real browser and writes ``workbench.json``.
``python -m tests.bench --page`` writes ``docs/accuracy.md`` from the last ``bench.json`` and measures nothing; with
``--workbench`` it writes ``docs/workbench.md`` from ``workbench.json``.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import tempfile
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from tests.bench.figures import Figure, figures
from tests.bench.page import page, table, workbench_page
from tests.bench.sequence import SEQUENCES, measured
from tests.bench.work import optimisations, reference_ms, seconds

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT.parent / "shared" / "data"
RESULT = ROOT / "bench.json"
WORKBENCH = ROOT / "workbench.json"
#: Parameters that make every frame a node.
_EVERY_FRAME = (
    "Rtabmap/DetectionRate=0",
    "RGBD/LinearUpdate=0",
    "RGBD/AngularUpdate=0",
    "Mem/RehearsalSimilarity=1",
)
PAGE, WORKBENCH_PAGE = ROOT / "docs" / "accuracy.md", ROOT / "docs" / "workbench.md"
MAPS = Path(tempfile.gettempdir()) / "slamdeck-workbench"


def main() -> None:
    """Runs every benchmark that this machine has the data for, or writes the page."""
    parser = argparse.ArgumentParser(prog="python -m tests.bench", description=__doc__)
    parser.add_argument("--page", action="store_true", help="write the page from what was measured last")
    parser.add_argument("--data", type=Path, default=DATA, help="folder of the sequences")
    parser.add_argument("--workbench", action="store_true", help="measure the page instead; takes long")
    parser.add_argument("--plantings", type=int, default=100, help="of false loops in each map, for --workbench")
    parser.add_argument("--planted", nargs="*", default=[], help="maps in which they are planted; all unless given")
    parser.add_argument("--maps", type=Path, default=MAPS, help="where maps that --workbench makes are kept")
    options = parser.parse_args()
    if options.page and options.workbench:
        WORKBENCH_PAGE.write_text(workbench_page(json.loads(WORKBENCH.read_text(encoding="utf-8"))), encoding="utf-8")
        print(WORKBENCH_PAGE)
        return
    if options.page:
        result = json.loads(RESULT.read_text(encoding="utf-8"))
        PAGE.write_text(page(result), encoding="utf-8")
        print(PAGE)
        return
    if options.workbench:
        _measure_workbench(options.data, options.maps, options.planted, options.plantings)
        return
    result = _result(options.data)
    RESULT.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    print("\n".join(table(result)))
    print(RESULT)


def _measure_workbench(data: Path, maps: Path, planted: list[str], plantings: int) -> None:
    # Needs Playwright, which the other figures do without.
    from tests.bench.workbench import workbench

    result: dict[str, Any] = {"commit": _commit(), "date": datetime.now(UTC).date().isoformat(), "machine": _machine()}
    result |= {"reference_ms": reference_ms(), "figures": []}
    for figure in workbench(data, maps, planted, plantings):
        result["figures"].append(figure._asdict() | {"load": round(os.getloadavg()[0], 1)})
        # It takes long: what was measured is kept whatever comes after it.
        WORKBENCH.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    print("\n".join(table(result)))
    print(WORKBENCH)


def _machine() -> dict[str, Any]:
    return {
        "cores": os.cpu_count(),
        "load": round(os.getloadavg()[0], 1),
        "python": platform.python_version(),
        "system": platform.machine(),
    }


def _result(data: Path) -> dict[str, Any]:
    machine = _machine()
    works = optimisations() | {
        "import of the command line, s": seconds("import server.cli"),
        "import of the server, s": seconds("import server.app"),
        "import of the engine, s": seconds("import slam.slam"),
    }
    here = [name for name in SEQUENCES if (data / name).is_dir()]
    sequences = {name: measured(str(data / name)) for name in here} or {"tour": measured("tour:frames=300")}
    full = None
    if "hololens_tour" in here:
        full = measured(str(data / "hololens_tour"), *_EVERY_FRAME)
    found: list[Figure] = figures(sequences, full, works)
    return {
        "commit": _commit(),
        "date": datetime.now(UTC).date().isoformat(),
        "machine": machine,
        "reference_ms": reference_ms(),
        "figures": [figure._asdict() for figure in found],
        "sequences": sequences,
    }


def _commit() -> str:
    said = subprocess.run(
        ["git", "describe", "--always", "--dirty"], check=False, cwd=ROOT, capture_output=True, text=True
    )
    return said.stdout.strip() or "unknown"


if __name__ == "__main__":
    main()
