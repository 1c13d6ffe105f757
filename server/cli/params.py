"""``slamdeck params``: all parameters."""

from __future__ import annotations

import json as json_format
from dataclasses import asdict
from typing import Annotated

import typer

from server.cli.markdown import bounds, parameters_page
from slam.errors import ParameterError
from slam.params import ParamSpec, format_value, specs


def params(
    json: Annotated[bool, typer.Option("--json", help="Print a JSON list.")] = False,
    markdown: Annotated[bool, typer.Option("--markdown", help="Print all as the page docs/parameters.md.")] = False,
    search: Annotated[str, typer.Option(help="Only those whose name or meaning holds this text.")] = "",
) -> None:
    """List parameters with defaults, units, bounds and meaning."""
    if markdown:
        typer.echo(parameters_page(), nl=False)
        return
    found = [spec for spec in specs() if search.lower() in f"{spec.name} {spec.meaning}".lower()]
    if not found:
        raise ParameterError(f"no parameter's name or meaning holds {search!r}; `slamdeck params` lists them all")
    if json:
        typer.echo(json_format.dumps([asdict(spec) for spec in found]))
        return
    from rich.console import Console
    from rich.table import Table

    table = Table(box=None, padding=(0, 2, 0, 0), header_style="bold")
    for title in ("name", "default", "unit", "bounds", "takes effect", "meaning"):
        table.add_column(title, no_wrap=title == "name", overflow="fold")
    for spec in found:
        table.add_row(spec.name, _short(spec), spec.unit, bounds(spec), spec.effect.value, spec.meaning)
    Console().print(table)


def _short(spec: ParamSpec) -> str:
    text = format_value(spec.default)
    return text if len(text) <= 12 else f"{text[:9]}..."
