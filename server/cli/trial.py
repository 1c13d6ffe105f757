"""``slamdeck try``: what other parameters would make of a map, beside its replay as it was."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer

from server.cli.options import ConfigOption, JsonOption, ParamOption, parameters

if TYPE_CHECKING:
    from server.schemas import TrialComparison, TrialSide
    from slam.tools.trial import Comparison
    from slam.tools.wanted import Wanted


def try_parameters(
    file: Annotated[Path, typer.Argument(help="Map file; it stays as it is.")],
    param: ParamOption = None,
    config: ConfigOption = None,
    keep: Annotated[Path | None, typer.Option(help="Make a map file of what was tried.")] = None,
    json: JsonOption = False,
) -> None:
    """Replay a map as it was and with other parameters, from what is stored of its nodes, and compare both."""
    from server.browse.trial_outcome import trial_comparison
    from slam.database import MapReader
    from slam.tools.kept import keep as keep_trial
    from slam.tools.output import check_target
    from slam.tools.wanted import Wanted as ToTry

    if keep is not None:
        check_target(keep, [file])
    wanted = ToTry(file, parameters(config, param), {})
    with TemporaryDirectory(prefix="slamdeck-try-") as scratch:
        found = _carried_out(wanted, Path(scratch))
        if keep is not None:
            keep_trial(Path(scratch) / "tried.db", found.old_ids, file, keep)
        told = trial_comparison(MapReader(file), found)
    if json:
        typer.echo(told.model_dump_json(by_alias=True))
    else:
        _show(told)


def _carried_out(wanted: Wanted, scratch: Path) -> Comparison:
    from rich.console import Console
    from rich.progress import Progress

    from slam.tools.trial import carry_out

    terminal = Console(stderr=True)
    with Progress(console=terminal, transient=True, disable=not terminal.is_terminal) as bar:
        task = bar.add_task("getting ready", total=1.0)
        return carry_out(
            wanted,
            scratch / "as-it-was.db",
            scratch / "tried.db",
            lambda share, text: bar.update(task, completed=share, description=text),
        )


def _show(told: TrialComparison) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table("", "map", "as it was", "tried")
    for name in _numbers(told.tried):
        table.add_row(name, *(_numbers(side)[name] for side in (told.original, told.baseline, told.tried)))
    console = Console()
    console.print(table)
    console.print(
        f"without changes the replay differs from the map by {told.unlike} loops and {told.drift_m * 1000:.1f} mm"
    )
    for what, loops in (("comes", told.came), ("goes", told.gone)):
        for loop in loops:
            console.print(f"{what} {loop.key} {loop.type}: {loop.reason or 'it was not tried'}", highlight=False)


def _numbers(side: TrialSide) -> dict[str, str]:
    loops = ", ".join(f"{count} {kind}" for kind, count in side.loops.items())
    values: dict[str, float | int | str | None] = {
        "nodes": side.nodes,
        "loops": loops or "none",
        "refused": side.refused,
        "ATE, m": side.ate_m,
        "path, m": side.path_m,
        "update median, ms": side.median_ms,
        "update longest, ms": side.max_ms,
        "largest WM": side.wm_max,
        "largest STM": side.stm_max,
        "LTM at the end": side.ltm_end,
        "transferred": side.transferred,
        "retrieved": side.retrieved,
    }
    return {name: "-" if v is None else f"{v:.4g}" if isinstance(v, float) else str(v) for name, v in values.items()}
