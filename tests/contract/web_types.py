"""The page's API types, generated from the server's OpenAPI; run as a script it writes web/types/api.d.ts anew."""

from __future__ import annotations

import tempfile
from pathlib import Path

from server.openapi import openapi_text
from tests.contract.node_tools import TYPES, run_tool


def generate(folder: Path) -> str:
    """Text of the types as they should be; ``folder`` takes the intermediate files."""
    description, types = folder / "openapi.json", folder / "api.d.ts"
    description.write_text(openapi_text())
    done = run_tool("openapi-typescript/bin/cli.js", str(description), "--output", str(types))
    assert done.returncode == 0, done.stdout + done.stderr
    return types.read_text()


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        TYPES.write_text(generate(Path(folder)))
