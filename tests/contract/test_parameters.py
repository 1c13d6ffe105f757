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
    for scope in ast.walk(tree):
        if isinstance(scope, ast.FunctionDef | ast.Module):
            held = _held(scope)
            for node in ast.walk(scope):
                if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
                    yield from (f"{group}/{node.attr}" for group in _groups(node.value, held))


def _groups(node: ast.expr, held: dict[str, set[str]]) -> set[str]:
    if isinstance(node, ast.Name):
        return held.get(node.id, set())
    group = _group(node)
    return set() if group is None else {group}


def _held(scope: ast.FunctionDef | ast.Module) -> dict[str, set[str]]:
    """Variables of a function that hold a group: assigned, or arguments that are annotated as either of two."""
    found: dict[str, set[str]] = {}
    if isinstance(scope, ast.FunctionDef):
        for argument in scope.args.args:
            if isinstance(argument.annotation, ast.Name) and argument.annotation.id == "Wanted":
                found[argument.arg] = {"Kp", "Vis"}
        for node in ast.walk(scope):
            if isinstance(node, ast.Assign):
                for target, value in _pairs(node):
                    group = _group(value)
                    if isinstance(target, ast.Name) and group is not None:
                        found[target.id] = {group}
    return found


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
