"""``slamdeck params``: what can be tuned."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Annotated

import typer

from server.cli.options import Json
from slam.errors import ParameterError
from slam.params import ParamSpec, format_value, specs


def params(
    search: Annotated[str, typer.Argument(help="Part of a name or of its meaning; all when left out.")] = "",
    json_: Json = False,
) -> None:
    """List the parameters with default, bounds, unit, and when a change takes effect."""
    found = [spec for spec in specs() if search.lower() in f"{spec.name} {spec.meaning}".lower()]
    if not found:
        raise ParameterError(f"no parameter has {search!r} in its name or meaning; `slamdeck params` lists all")
    if json_:
        print(json.dumps([asdict(spec) for spec in found]))
        return
    width = max(len(spec.name) for spec in found)
    for spec in found:
        print(f"{spec.name:<{width}}  {_value(spec)}\n{'':<{width}}  {spec.meaning} ({spec.effect.value})")


def _value(spec: ParamSpec) -> str:
    bounds = ""
    if spec.minimum is not None or spec.maximum is not None:
        low = "" if spec.minimum is None else f"{spec.minimum:g}"
        high = "" if spec.maximum is None else f"{spec.maximum:g}"
        bounds = f"  [{low} .. {high}]"
    return f"{format_value(spec.default)} {spec.unit}".rstrip() + bounds
