"""``slamdeck params``: all parameters."""

from __future__ import annotations

import json as json_format
from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated

import typer

from server.cli.markdown import bounds, parameters_page
from slam.errors import ParameterError
from slam.params import ParamSpec, format_value, specs

if TYPE_CHECKING:
    from rich.console import Group
    from rich.table import Table

#: Columns of a terminal in which the meaning has room beside the rest.
_WIDE = 120
_ENDLESS = 10_000


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

    console = Console()
    if not console.is_terminal:
        # What is piped is searched line by line: a parameter is one line there.
        console = Console(width=_ENDLESS)
    if console.width >= _WIDE:
        console.print(_table(found))
    else:
        console.print(*(_paragraph(spec) for spec in found), sep="")


def _table(found: Sequence[ParamSpec]) -> Table:
    from rich.table import Table

    table = Table(box=None, padding=(0, 2, 0, 0), header_style="bold")
    for title in ("name", "default", "unit", "bounds", "takes effect", "meaning"):
        table.add_column(title, no_wrap=title != "meaning", overflow="fold")
    for spec in found:
        table.add_row(*_facts(spec), spec.meaning)
    return table


def _paragraph(spec: ParamSpec) -> Group:
    """For narrow terminals: the meaning below the rest."""
    from rich.console import Group
    from rich.padding import Padding
    from rich.text import Text

    name, *others = _facts(spec)
    line = Text.assemble((name, "bold"), "  ", "  ".join(part for part in others if part))
    return Group(line, Padding(Text(spec.meaning), (0, 0, 0, 4)))


def _facts(spec: ParamSpec) -> tuple[str, str, str, str, str]:
    return spec.name, _short(spec), spec.unit, bounds(spec), spec.effect.value


def _short(spec: ParamSpec) -> str:
    text = format_value(spec.default)
    return text if len(text) <= 12 else f"{text[:9]}..."
