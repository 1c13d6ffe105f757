"""The page is type-checked against the server's own OpenAPI."""

from __future__ import annotations

from pathlib import Path

from tests.contract.node_tools import TYPES, run_tool
from tests.contract.web_types import generate


def test_generated_types_are_up_to_date(tmp_path: Path) -> None:
    """On failure: ``python -m tests.contract.web_types`` writes web/types/api.d.ts anew."""
    assert generate(tmp_path) == TYPES.read_text()


def test_the_page_passes_the_type_check() -> None:
    done = run_tool("typescript/bin/tsc", "--noEmit")
    assert done.returncode == 0, done.stdout
