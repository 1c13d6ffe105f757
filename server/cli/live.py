"""A run that is watched in the browser."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import typer

from server.engine.commands import RunJob
from server.engine.events import Ended, Event
from server.settings import Settings
from slam.errors import DatabaseError
from slam.params import Value

OnSummary = Callable[[Mapping[str, Any]], None]


def run_live(
    settings: Settings,
    source: str,
    path: Path,
    values: Mapping[str, Value],
    *,
    seed: int,
    speed: float,
    overwrite: bool,
    append: bool = False,
    note: str,
    on_summary: OnSummary | None = None,
) -> None:
    """Serve, and map a source meanwhile; goes on serving when the run has ended.

    Raises:
        SourceError, DatabaseError, SettingsError: what can be checked before the first frame is refused here.
    """
    from server.app import FirstRun
    from server.cli.serve import serve_maps
    from slam.sensors import open_source

    open_source(source)
    check_target(path, values, overwrite=overwrite, append=append)

    def told(event: Event) -> None:
        if isinstance(event, Ended) and event.error is not None:
            typer.echo(f"error: {event.error}", err=True)
        elif isinstance(event, Ended) and event.summary is not None and on_summary is not None:
            on_summary(event.summary)

    job = RunJob(source, path.resolve(), values, seed, speed, overwrite, append)
    serve_maps(settings, FirstRun(path.name.removesuffix(".db"), job, told), note)


def check_target(path: Path, values: Mapping[str, Value], *, overwrite: bool, append: bool = False) -> None:
    """Raises DatabaseError where no new map can be made and none is to be gone on with."""
    from slam.params import Params

    if not Params().changed(values).Mem.IncrementalMemory:
        _check_map_to_localize_in(path, overwrite=overwrite)
        return
    if overwrite and append:
        raise DatabaseError(f"{path} is either replaced (--overwrite) or gone on with (--append), not both")
    if path.suffix != ".db":
        raise DatabaseError(f"{path}: a map file's name ends in .db, as in {path.stem or 'map'}.db")
    if not path.parent.is_dir():
        raise DatabaseError(f"{path} can't be made: the folder {path.parent} does not exist")
    if path.exists() and not (overwrite or append):
        raise DatabaseError(
            f"{path} exists already: choose another name, replace it with --overwrite, "
            "or add a session to it with --append"
        )


def _check_map_to_localize_in(path: Path, *, overwrite: bool) -> None:
    if overwrite:
        raise DatabaseError(f"{path} can't be replaced and localised in: leave --overwrite out")
    if not path.is_file():
        raise DatabaseError(f"{path} does not exist: to localise, name the file of a map that was made before")
