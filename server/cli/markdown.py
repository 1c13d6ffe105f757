"""``docs/parameters.md``: the registry as a page."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

from slam.params import Params, ParamSpec, format_value, specs
from slam.params.ini import rtabmap_default

_HEAD = """# Parameters

Made from the registry by `slamdeck params --markdown`. Names are RTAB-Map's; its default stands beside
slamdeck's where it is another one (its builds differ in some), and `none` where it has no such parameter.
What is `live` counts from the next update on, `next session` from the next run.
"""
_COLUMNS = ("name", "type", "default", "RTAB-Map", "unit", "bounds", "takes effect", "meaning")


def parameters_page() -> str:
    """The page as Markdown, one table for each group."""
    lines = [_HEAD]
    for group, entries in groupby(specs(), key=lambda entry: entry.name.partition("/")[0]):
        about = (Params.model_fields[group].annotation or Params).__doc__ or ""
        lines += [f"## {group}", "", about.strip(), "", _row(_COLUMNS), _row(["---"] * len(_COLUMNS))]
        lines += [_row(_cells(entry)) for entry in entries]
        lines.append("")
    return "\n".join(lines)


def bounds(spec: ParamSpec) -> str:
    """Bounds or choices in words, empty where any value is right."""
    if spec.choices:
        return ", ".join(map(str, spec.choices))
    low = "" if spec.minimum is None else f">= {spec.minimum:g}"
    high = "" if spec.maximum is None else f"<= {spec.maximum:g}"
    return " ".join(part for part in (low, high) if part)


def _cells(entry: ParamSpec) -> Iterator[str]:
    yield f"`{entry.name}`"
    yield entry.type
    yield format_value(entry.default)
    yield _elsewhere(entry)
    yield entry.unit
    yield bounds(entry)
    yield entry.effect.value
    yield entry.meaning


def _elsewhere(entry: ParamSpec) -> str:
    """RTAB-Map's default where it is another one."""
    theirs = rtabmap_default(entry.name)
    if theirs is None:
        return "none"
    if not theirs or theirs == format_value(entry.default):
        return ""
    return "" if entry.type in ("int", "float") and float(theirs) == float(entry.default) else theirs


def _row(cells: list[str] | tuple[str, ...] | Iterator[str]) -> str:
    return f"| {' | '.join(cell.replace('|', '/') for cell in cells)} |"
