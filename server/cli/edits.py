"""``slamdeck detect``, ``refine`` and ``regrid``: more loops, better links, other local grids, in a map file."""

from __future__ import annotations

import json as json_format
from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from server.cli.options import ConfigOption, JsonOption, ParamOption, parameters
from slam.errors import ParameterError

if TYPE_CHECKING:
    from slam.edit.job import Job
    from slam.edit.views import StoredViews
    from slam.effect import Effect
    from slam.review import Review


class Method(StrEnum):
    """How two nodes are registered."""

    VISUAL = "visual"
    ICP = "icp"
    BOTH = "both"


class Guess(StrEnum):
    """Where a registration begins."""

    GRAPH = "graph"
    NONE = "none"


FileArgument = Annotated[Path, typer.Argument(metavar="FILE", help="A map file; it is changed.")]
MethodOption = Annotated[Method, typer.Option(help="By images, by clouds, or by images and from there by clouds.")]
IntraOption = Annotated[bool, typer.Option(help="Pairs of one session.")]
InterOption = Annotated[bool, typer.Option(help="Pairs of two sessions.")]
SessionOption = Annotated[int, typer.Option(min=-1, help="Only with a node of this session; -1 for all.")]
AuthorOption = Annotated[str, typer.Option(help="Name for the journal.")]
VerboseOption = Annotated[bool, typer.Option("--verbose", "-v", help="A line for every pair or link, on stderr.")]


def detect(
    path: FileArgument,
    radius: Annotated[float, typer.Option(min=0.001, help="Largest distance of two nodes, metres.")] = 1.0,
    min_radius: Annotated[float, typer.Option(min=0, help="Smallest distance of two nodes, metres.")] = 0.0,
    angle: Annotated[float, typer.Option(min=0, max=180, help="Largest angle between where they look, degrees.")] = 30,
    iterations: Annotated[int, typer.Option(min=1, help="Rounds, each with the poses of the last.")] = 5,
    min_distance: Annotated[int, typer.Option(min=0, help="Fewest links between two nodes of a session.")] = 10,
    intra: IntraOption = True,
    inter: InterOption = True,
    session: SessionOption = -1,
    method: MethodOption = Method.VISUAL,
    guess: Annotated[Guess, typer.Option(help="Begin at the optimised poses, or without any idea.")] = Guess.NONE,
    param: ParamOption = None,
    config: ConfigOption = None,
    author: AuthorOption = "slamdeck detect",
    verbose: VerboseOption = False,
    json: JsonOption = False,
) -> None:
    """Look for more loop closures among nodes that are close, and add them to the map as one batch.

    One undo on the page takes the batch back. Ctrl+C leaves the map as it was.
    """
    from slam.edit.detect import detect_more
    from slam.edit.wishes import Detection

    wanted = Detection(
        radius_m=radius,
        min_radius_m=min_radius,
        angle_deg=angle,
        iterations=iterations,
        min_graph_distance=min_distance,
        intra=intra,
        inter=inter,
        session=session,
        method=method.value,
        guess=guess.value,
    )
    changes = parameters(config, param)
    told = _carry_out(path, changes, lambda review, views: detect_more(review, views, wanted, author), verbose=verbose)
    _show(*told, as_json=json)


def refine(
    path: FileArgument,
    type: Annotated[
        list[str] | None, typer.Option("--type", metavar="TYPE", help="Neighbor, GlobalClosure, ...; all without it.")
    ] = None,
    first: Annotated[int, typer.Option(min=0, help="Smallest id of a node.")] = 0,
    last: Annotated[int, typer.Option(min=0, help="Largest id of a node; 0 for no limit.")] = 0,
    intra: IntraOption = True,
    inter: InterOption = True,
    session: SessionOption = -1,
    method: MethodOption = Method.VISUAL,
    covariance_only: Annotated[bool, typer.Option("--covariance-only", help="Leave the transforms.")] = False,
    param: ParamOption = None,
    config: ConfigOption = None,
    author: AuthorOption = "slamdeck refine",
    verbose: VerboseOption = False,
    json: JsonOption = False,
) -> None:
    """Register links anew, from what they say, and put them into the map as one batch.

    One undo on the page takes the batch back. Ctrl+C leaves the map as it was.
    """
    from slam.edit.refine import refine_links
    from slam.edit.wishes import Refinement
    from slam.types import LinkType

    kinds = {kind.label: kind for kind in LinkType}
    for name in type or []:
        if name not in kinds:
            raise ParameterError(f"--type {name!r} is no kind of link: {', '.join(kinds)} are")
    wanted = Refinement(
        types=tuple(kinds[name] for name in type or []),
        first=first,
        last=last,
        intra=intra,
        inter=inter,
        session=session,
        method=method.value,
        covariance_only=covariance_only,
    )
    changes = parameters(config, param)
    told = _carry_out(path, changes, lambda review, views: refine_links(review, views, wanted, author), verbose=verbose)
    _show(*told, as_json=json)


def regrid(
    path: FileArgument,
    first: Annotated[int, typer.Option(min=0, help="Smallest id of a node.")] = 0,
    last: Annotated[int, typer.Option(min=0, help="Largest id of a node; 0 for no limit.")] = 0,
    session: Annotated[int, typer.Option(min=-1, help="Only nodes of this session; -1 for all.")] = -1,
    param: ParamOption = None,
    config: ConfigOption = None,
    author: AuthorOption = "slamdeck regrid",
    verbose: VerboseOption = False,
    json: JsonOption = False,
) -> None:
    """Make local grids anew of the stored depth, with other parameters of Grid/, and the floor plan of them.

    One undo on the page takes it back. Ctrl+C leaves the map as it was.
    """
    from slam.database import MapReader
    from slam.edit.grids import regrid as made_anew
    from slam.edit.wishes import Regrid

    wanted = Regrid(changes=parameters(config, param), first=first, last=last, session=session)
    reader = MapReader(path)
    told = _carry_out(path, {}, lambda review, _: made_anew(review, reader, wanted, author), verbose=verbose)
    _show(*told, as_json=json)


def _carry_out(
    path: Path,
    changes: dict[str, Any],
    begin: Callable[[Review, StoredViews], Job],
    *,
    verbose: bool,
) -> tuple[Effect | None, str]:
    """What a job did to a map, and its last line."""
    from server.engine.opened import opened
    from slam.edit.views import StoredViews

    with opened(path) as map_file:
        map_file.review.params = map_file.params.changed(changes)
        effect, last = _run(begin(map_file.review, StoredViews(map_file.reader)), verbose=verbose)
        if effect is not None:
            map_file.grid.carry_out()
    return effect, last


def _run(job: Job, *, verbose: bool) -> tuple[Effect | None, str]:
    """What it did, and its last line; a bar on stderr where that is a terminal."""
    from rich.console import Console
    from rich.progress import Progress

    terminal, last = Console(stderr=True), ""
    with Progress(console=terminal, transient=True, disable=not terminal.is_terminal) as bar:
        task = bar.add_task("", total=1.0)
        while True:
            try:
                step = next(job)
            except StopIteration as end:
                return end.value, last
            bar.update(task, completed=step.share)
            last = step.text or last
            if verbose and step.text:
                terminal.print(step.text, highlight=False, soft_wrap=True)


def _show(effect: Effect | None, last: str, *, as_json: bool) -> None:
    if effect is not None:
        show_effect(effect, last, as_json=as_json)
    elif as_json:
        typer.echo(json_format.dumps({"result": last, "changed": 0, "batch": None}))
    else:
        typer.echo(f"{last}; the map is as it was")


def show_effect(effect: Effect, what: str, *, as_json: bool) -> None:
    """Print what was done to a map, and what that did."""
    if as_json:
        told = {"changed": len(effect.entries), "batch": effect.entry.batch or effect.entry.id}
        typer.echo(json_format.dumps({"result": what, **told, **_numbers(effect)}))
    else:
        typer.echo(what)
        typer.echo(f"chi2 {effect.chi2_before:.1f} -> {effect.chi2_after:.1f}")
        typer.echo(f"moved {effect.moved} poses, at most {100 * effect.max_shift_m:.1f} cm")
        if effect.ate_before is not None and effect.ate_after is not None:
            typer.echo(f"trajectory error {100 * effect.ate_before:.2f} -> {100 * effect.ate_after:.2f} cm")


def _numbers(effect: Effect) -> dict[str, float | int | None]:
    return {
        "chi2_before": effect.chi2_before,
        "chi2_after": effect.chi2_after,
        "moved": effect.moved,
        "max_shift_m": effect.max_shift_m,
        "ate_before_m": effect.ate_before,
        "ate_after_m": effect.ate_after,
    }
