"""Every registered parameter is read by some code, and the page that lists them is the one that the registry gives."""

from __future__ import annotations

import ast
from collections.abc import Iterator

import pytest

from server.cli.markdown import parameters_page
from slam.params import Params, spec, specs
from slam.params.ini import known_unused
from tests.conftest import ROOT

PAGE = ROOT / "docs" / "parameters.md"
GROUPS = set(Params.model_fields)


def reads(source: str) -> Iterator[str]:
    """Full names of the parameters that a module reads, by way of a variable that holds their group too."""
    tree = ast.parse(source)
    held = {
        target.id: group
        for node in ast.walk(tree)
        if isinstance(node, ast.Assign)
        for target, value in _pairs(node)
        if isinstance(target, ast.Name) and (group := _group(value)) is not None
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
            group = held.get(node.value.id) if isinstance(node.value, ast.Name) else _group(node.value)
            if group is not None:
                yield f"{group}/{node.attr}"


def _pairs(node: ast.Assign) -> Iterator[tuple[ast.expr, ast.expr]]:
    for target in node.targets:
        if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
            yield from zip(target.elts, node.value.elts, strict=False)
        else:
            yield target, node.value


def _group(node: ast.expr) -> str | None:
    return node.attr if isinstance(node, ast.Attribute) and node.attr in GROUPS else None


@pytest.fixture(scope="module")
def read() -> set[str]:
    files = [file for folder in ("slam", "server") for file in sorted((ROOT / folder).rglob("*.py"))]
    modules = [file for file in files if ROOT / "slam" / "params" not in file.parents]
    return {name for file in modules for name in reads(file.read_text(encoding="utf-8"))}


@pytest.mark.parametrize("name", [entry.name for entry in specs()])
def test_some_code_reads_it(name: str, read: set[str]) -> None:
    assert name in read, f"{name} is registered, but no code in slam/ or server/ reads params.{name.replace('/', '.')}"


def test_the_search_finds_reads_and_no_others() -> None:
    source = (
        "def f(params, other):\n    kp, vis = params.Kp, self.params.Vis\n    return kp.NndrRatio, vis.MinInliers, "
    )
    source += "params.RGBD.LocalRadius, params.Kp, other.MaxFeatures\n# params.Mem.STMSize\n'params.Rtabmap.LoopThr'\n"
    assert set(reads(source)) == {"Kp/NndrRatio", "Vis/MinInliers", "RGBD/LocalRadius"}


def test_the_page_is_up_to_date() -> None:
    assert PAGE.read_text(encoding="utf-8") == parameters_page(), "run: slamdeck params --markdown > docs/parameters.md"


def test_the_page_names_all_and_says_where_rtabmap_differs() -> None:
    page = parameters_page()
    assert all(f"| `{entry.name}` |" in page for entry in specs())
    row = next(line for line in page.splitlines() if line.startswith("| `Rtabmap/DetectionRate`"))
    assert "| 2.0 | 1 | Hz | >= 0 |" in row
    assert not known_unused("Rtabmap/DetectionRate") and spec("Rtabmap/DetectionRate").default == 2.0
