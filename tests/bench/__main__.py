"""``make bench``: a table on standard output, and the same as JSON in ``bench.json``.

The machine's own reference work (feature extraction on a fixed image) stands beside it: quote ratios within one run.
``python -m tests.bench --workbench`` measures the page in a real browser and writes ``workbench.json``.
``python -m tests.bench --page`` writes ``docs/accuracy.md`` from the last ``bench.json`` and measures nothing.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from tests.bench.figures import Figure, figures
from tests.bench.page import page, table
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
PAGE = ROOT / "docs" / "accuracy.md"


def main() -> None:
    """Runs every benchmark that this machine has the data for, or writes the page."""
    parser = argparse.ArgumentParser(prog="python -m tests.bench", description=__doc__)
    parser.add_argument("--page", action="store_true", help="write docs/accuracy.md from bench.json")
    parser.add_argument("--data", type=Path, default=DATA, help="folder of the sequences")
    parser.add_argument("--workbench", action="store_true", help="measure the page instead; takes long")
    parser.add_argument("--plantings", type=int, default=100, help="of false loops in each map, for --workbench")
    options = parser.parse_args()
    if options.page:
        result = json.loads(RESULT.read_text(encoding="utf-8"))
        PAGE.write_text(page(result), encoding="utf-8")
        print(PAGE)
        return
    if options.workbench:
        _measure_workbench(options.data, options.plantings)
        return
    result = _result(options.data)
    RESULT.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    print("\n".join(table(result)))
    print(RESULT)


def _measure_workbench(data: Path, plantings: int) -> None:
    # Needs Playwright, which the other figures do without.
    from tests.bench.workbench import workbench

    result = {"commit": _commit(), "load": round(os.getloadavg()[0], 1), "reference_ms": reference_ms()}
    result["figures"] = [figure._asdict() for figure in workbench(data, plantings)]
    WORKBENCH.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    print("\n".join(table(result)))
    print(WORKBENCH)


def _result(data: Path) -> dict[str, Any]:
    load = round(os.getloadavg()[0], 1)
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
        "machine": {
            "cores": os.cpu_count(),
            "load": load,
            "python": platform.python_version(),
            "system": platform.machine(),
        },
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
