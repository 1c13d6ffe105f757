"""``slamdeck run``: a source becomes a map."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from server.cli.options import DEFAULT_HOST, DEFAULT_PORT, Config, Host, Json, NoToken, Param, Port, Seed, read_params
from slam.errors import DatabaseError, SlamError

if TYPE_CHECKING:
    from slam.params import Params
    from slam.run import Tally
    from slam.sensors import Source
    from slam.slam import Slam
    from slam.types import Update


def run(
    source: Annotated[str, typer.Argument(help="TUM RGB-D folder, or tour:laps=2,... for the rendered tour.")],
    db: Annotated[Path | None, typer.Option("--db", help="Map file to make; default: <source>.db here.")] = None,
    param: Param = None,
    config: Config = None,
    seed: Seed = 0,
    json_: Json = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the map file if there is one.")] = False,
    serve: Annotated[bool, typer.Option("--serve", help="Watch the run in the browser.")] = False,
    host: Host = DEFAULT_HOST,
    port: Port = DEFAULT_PORT,
    no_token: NoToken = False,
) -> None:
    """Map a recorded sequence; with --serve, live in the browser."""
    params = read_params(config, param)
    path = db or Path(f"{_stem(source)}.db")
    if serve:
        from server.cli.live import serve_run

        serve_run(source, path, params, seed, overwrite=overwrite, host=host, port=port, no_token=no_token)
        return
    summary = _map(source, path, params, seed, overwrite=overwrite)
    if json_:
        print(json.dumps(summary))
    else:
        _print(summary, path)


def _map(source: str, path: Path, params: Params, seed: int, *, overwrite: bool) -> dict[str, Any]:
    """Runs a source into a new file; whatever was mapped before an error or an interruption stays, closed in order."""
    from slam.database import MapWriter, remove_map
    from slam.sensors import open_source
    from slam.slam import Slam

    opened = open_source(source)
    if overwrite:
        remove_map(path)
    slam = Slam(params, MapWriter.create(path, params, seed=seed, source=source), seed=seed, source=source)
    try:
        tally = _with_progress(opened, slam)
    except DatabaseError:
        slam.abandon()
        raise
    except (SlamError, KeyboardInterrupt):
        slam.close()
        raise
    slam.close()
    return tally.summary(slam, seed=seed, path=path)


def _with_progress(source: Source, slam: Slam) -> Tally:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from slam.run import run as run_all

    console = Console(stderr=True)
    columns = (TextColumn("mapping"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}"))
    with Progress(*columns, TimeRemainingColumn(), console=console, disable=not sys.stderr.isatty()) as progress:
        task = progress.add_task("", total=len(source))

        def show(update: Update) -> None:
            said = f"{len(slam.graph)} nodes" + ("" if update.odometry.lost is None else " · lost")
            progress.update(task, advance=1, description=said)

        return run_all(source, slam, show)


def _stem(source: str) -> str:
    return "tour" if source.startswith("tour:") else Path(source).resolve().name


def _print(summary: dict[str, Any], path: Path) -> None:
    loops, median = summary["loops"], summary["median_ms"]
    links = ", ".join(f"{count} {name}" for name, count in summary["links"].items())
    ate = "no ground truth" if summary["ate_rmse_m"] is None else f"{100 * summary['ate_rmse_m']:.2f} cm"
    print(f"frames    {summary['frames']}, {summary['lost_frames']} lost, {summary['fps']:.1f} per second")
    print(f"nodes     {summary['nodes']}   links {links or 'none'}")
    print(f"loops     {loops['global']} global, {loops['proximity']} proximity, {loops['refused']} refused")
    print(f"error     {ate} (ATE RMSE, SE(3)-aligned, all frames)")
    print(f"median    odometry {median['odometry']} ms, update {median['update']} ms")
    print(f"memory    {summary['peak_rss_mb']} MB   map {summary['db_mb']} MB   seed {summary['seed']}")
    print(f"browse    slamdeck serve {path}")
