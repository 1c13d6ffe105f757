"""``slamdeck optimize`` and ``slamdeck turn``: all poses of a map file at once."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from server.cli.edits import AuthorOption, FileArgument, show_effect
from server.cli.options import JsonOption
from slam.errors import ParameterError

if TYPE_CHECKING:
    from server.engine.commands import KeepPoses, TurnMap
    from server.schemas import Optimised
    from slam.effect import Effect


class Solver(StrEnum):
    """Of GTSAM, in the order of their numbers."""

    LM = "lm"
    GAUSS_NEWTON = "gn"
    DOGLEG = "dogleg"


class RobustKernel(StrEnum):
    """By the names of ``Optimizer/RobustKernel``."""

    NONE = "none"
    DCS = "DCS"
    CAUCHY = "Cauchy"
    GNC = "GNC"


class Start(StrEnum):
    """Where an optimisation begins."""

    ODOMETRY = "odometry"
    MAP = "map"


class Frame(StrEnum):
    """What a map is laid over."""

    TRUTH = "truth"
    GPS = "gps"


def optimize(
    path: Annotated[Path, typer.Argument(metavar="FILE", help="A map file; it is changed with --keep alone.")],
    root: Annotated[int | None, typer.Option(min=1, help="The node held fixed.")] = None,
    ignore: Annotated[
        list[str] | None, typer.Option(metavar="TYPE", help="Links that don't count: GlobalClosure, Gravity, ...")
    ] = None,
    solver: Annotated[Solver | None, typer.Option(help="Instead of GTSAM/Optimizer.")] = None,
    kernel: Annotated[RobustKernel | None, typer.Option(help="Instead of Optimizer/Robust and its kernel.")] = None,
    start: Annotated[Start, typer.Option(help="Poses along the links from the root, or the map's.")] = Start.ODOMETRY,
    keep: Annotated[bool, typer.Option("--keep", help="Make the poses those of the map.")] = False,
    step: Annotated[
        int | None, typer.Option(min=0, help="The iteration that --keep keeps, 0 for the start; else the last.")
    ] = None,
    author: AuthorOption = "slamdeck optimize",
    json: JsonOption = False,
) -> None:
    """Optimise a map's graph in another manner and see each iteration; with --keep its poses become the map's.

    Links stay as they are: a later decision, or mapping on, optimises anew by the map's parameters with all links. One
    undo on the page takes the poses back.
    """
    from server.browse.optimising import Optimisations, wanted_optimisation
    from server.browse.snapshot import Snapshot
    from server.engine.commands import KeepPoses
    from server.schemas import KeepPoses as Wanted
    from server.schemas import OptimiseAsk
    from slam.database import MapReader

    ask = OptimiseAsk(
        root=root,
        without=ignore or [],
        solver=None if solver is None else list(Solver).index(solver),
        kernel=None if kernel is None else kernel.value,
        start=start.value,
    )
    if keep:
        effect = _carried_out(path, KeepPoses(wanted_optimisation(Wanted(ask=ask, step=step), author)))
        show_effect(effect, f"kept: {effect.entry.note}", as_json=json)
        return
    if step is not None:
        raise ParameterError("--step names the iteration that --keep keeps: give both, or neither")
    told = Optimisations().course(Snapshot(MapReader(path), 1, {}), ask).told
    typer.echo(told.model_dump_json(by_alias=True)) if json else _show(told)


def turn(
    path: FileArgument,
    yaw: Annotated[float, typer.Option(min=-360, max=360, help="Degrees about the map's z axis.")] = 0.0,
    to: Annotated[Frame | None, typer.Option(help="Lay it over the ground truth, or over GPS (x is east).")] = None,
    author: AuthorOption = "slamdeck turn",
    json: JsonOption = False,
) -> None:
    """Turn a whole map as it is, by an angle or over what is known from outside.

    One undo on the page takes it back.
    """
    from math import radians

    from server.engine.commands import TurnMap
    from slam.edit.wishes import Turn

    if (to is None) == (yaw == 0):
        raise ParameterError("name one of both: --yaw, other than 0, or --to")
    wanted = Turn(yaw_rad=radians(yaw), to=None if to is None else to.value, author=author)
    effect = _carried_out(path, TurnMap(wanted))
    show_effect(effect, f"turned {effect.entry.note}", as_json=json)


def _carried_out(path: Path, command: KeepPoses | TurnMap) -> Effect:
    from server.engine.edits import Edits
    from server.engine.opened import opened

    with opened(path) as map_file:
        effect = Edits(map_file.review, map_file.reader).change(command)
        map_file.grid.carry_out()
    return effect


def _show(told: Optimised) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table("", "chi2", "ATE, m", "path, m")
    states = {"map now": told.now, "start": told.steps[0]}
    states |= {f"iteration {k}": state for k, state in enumerate(told.steps[1:], 1)}
    for name, state in states.items():
        ate = "-" if state.ate_m is None else f"{state.ate_m:.4f}"
        table.add_row(name, f"{state.chi2:.6g}", ate, f"{state.path_m:.3f}")
    console = Console()
    console.print(table)
    console.print(
        f"{told.nodes} poses by {told.links} links from node {told.root};"
        f" the last are at most {told.max_shift_m:.3f} m from where the map has them",
        highlight=False,
    )
    if told.dropped:
        console.print(f"{told.dropped} nodes are not joined with it, and stay where they are", highlight=False)
    if told.outliers:
        pairs = ", ".join(f"{a}->{b}" for a, b in told.outliers)
        console.print(f"the kernel took the weight from {pairs}", highlight=False)
