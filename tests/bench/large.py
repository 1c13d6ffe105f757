"""``python -m tests.bench.large [nodes] [file]``: what it costs to open a map, else one of 10,000 nodes and 20 GB.

Each work is timed in a new process, with its peak of memory. A file that exists is measured as it is, else it is made
under that name; without a name it is made in a folder for temporary files and removed.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.bench.large_file import write_large_file

ROOT = Path(__file__).resolve().parents[2]
NODES = 10_000
_TIMED = """
import resource, sys, time
from pathlib import Path
path = Path(sys.argv[1])
{loaded}
start = time.perf_counter()
{work}
spent = time.perf_counter() - start
print([round(spent, 3), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024])
"""
_SERVER = """
import server.app
from server.browse import graph, loops, nodes, summary
from server.browse.map_view import MapView
from server.catalog import MapFile
"""
_SERVED = """
view = MapView(MapFile("map", "map", path))
summary.detail(view, live=False, writable=False).model_dump_json()
graph.graph(view, 0).model_dump_json()
nodes.page(view, offset=0, limit=100, order="id", query="").model_dump_json()
loops.loops(view.snapshot()).model_dump_json()
"""
_INFO_LOADED = """
import contextlib, io
from server.cli.info import info
"""
_INFO = """
with contextlib.redirect_stdout(io.StringIO()):
    info(path, json=False)
"""
#: Work -> what is imported before the clock runs, and what is timed.
WORKS = {
    "the server opens it, gives summary, graph, nodes and loops": (_SERVER, _SERVED),
    "slamdeck info": (_INFO_LOADED, _INFO),
}


def opened(path: Path) -> dict[str, tuple[float, int]]:
    """Seconds and peak memory (MB) of each work on a map file."""
    found = {}
    for name, (loaded, work) in WORKS.items():
        code = _TIMED.format(loaded=loaded, work=work)
        said = subprocess.run(
            [sys.executable, "-c", code, str(path)], cwd=ROOT, check=True, capture_output=True, text=True
        )
        seconds, megabytes = json.loads(said.stdout)
        found[name] = (float(seconds), int(megabytes))
    return found


def main() -> None:
    """Prints size, time and memory."""
    nodes = int(sys.argv[1]) if len(sys.argv) > 1 else NODES
    with tempfile.TemporaryDirectory() as folder:
        path = Path(sys.argv[2]) if len(sys.argv) > 2 else Path(folder) / "large.db"
        if not path.exists():
            write_large_file(path, nodes)
        state = path.stat()
        print(f"{path.name}: {state.st_size / 1e9:.1f} GB, {512 * state.st_blocks / 1e9:.1f} GB of disk")
        for name, (seconds, megabytes) in opened(path).items():
            print(f"{name}: {seconds:.2f} s, {megabytes} MB")


if __name__ == "__main__":
    main()
