"""An engine on a map file, closed in order whatever happens."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

from slam.database import MapReader, MapWriter
from slam.database.lock import MapLock
from slam.errors import DatabaseError
from slam.features.files import check_files
from slam.localization import Localization
from slam.memory.past import recall
from slam.params import Params, Value
from slam.slam import Slam
from slam.tools.parameters import taken

#: What holds for one run, whatever the runs before it were.
_OF_ONE_RUN: Mapping[str, Value] = {
    "Mem/IncrementalMemory": True,
    "Mem/LocalizationReadOnly": False,
    "Odom/External": 0,
}


def session_params(path: Path, values: Mapping[str, Value], *, append: bool) -> Params:
    """The parameters of a run: those named, and for the rest the defaults.

    A session of a map that is there (``append``, or localisation) has those of the map in place of the defaults, as in
    RTAB-Map: words and key points go on as they are, and what was taken over for it counts.

    Raises:
        ParameterError: one is unknown or out of bounds.
        DatabaseError: the map can't be read.
    """
    params = Params().changed(values)
    if not path.exists() or (params.Mem.IncrementalMemory and not append):
        return params
    return taken(MapReader(path)).params.changed({**_OF_ONE_RUN, **values})


@contextmanager
def engine_on_map(
    path: Path, params: Params, *, seed: int, source: str, overwrite: bool = False, append: bool = False
) -> Iterator[tuple[Slam, MapWriter | None]]:
    """An engine on a map file, and the writer; afterwards the session is ended and the file is one plain file.

    With ``Mem/IncrementalMemory`` false it localises in a map that is there; with ``Mem/LocalizationReadOnly`` too
    there is no writer.

    Args:
        path: of the map file.
        params: to start with.
        seed: of everything random.
        source: what the frames come from.
        overwrite: make a new file in the place of one that is there.
        append: go on with a file that is there, as a new session of it.

    Raises:
        ParameterError: a network or dictionary that the parameters name can't be read; then no file is touched.
        DatabaseError: the file exists and may not be replaced, is no map, or can't be made.
        MapBusyError: somebody writes it.
    """
    check_files(params)
    if not params.Mem.IncrementalMemory and params.Mem.LocalizationReadOnly:
        yield Localization(params, recall(MapReader(path), params, seed=seed), seed=seed, source=source), None
        return
    if not params.Mem.IncrementalMemory or (append and path.exists()):
        opening = _engine_on_old_map(path, params, seed, source)
    else:
        if overwrite and path.exists():
            _remove(path)
        writer = MapWriter.create(path, params, seed=seed, source=source)
        opening = Slam(params, writer, seed=seed, source=source), writer
    slam, writer = opening
    with writer:
        try:
            yield slam, writer
        finally:
            slam.close()


def _engine_on_old_map(path: Path, params: Params, seed: int, source: str) -> tuple[Slam, MapWriter]:
    with ExitStack() as undo:
        writer = MapWriter.open(path)
        undo.callback(writer.close)
        # Read before the session begins: a map that can't be gone on with stays as it is.
        past = recall(MapReader(path), params, seed=seed)
        writer.start_session(params, seed=seed, source=source)
        undo.pop_all()
    if params.Mem.IncrementalMemory:
        return Slam(params, writer, seed=seed, source=source, past=past), writer
    return Localization(params, past, writer, seed=seed, source=source), writer


def _remove(path: Path) -> None:
    if not path.is_file():
        raise DatabaseError(f"{path} is no file that could be replaced: name a map file")
    lock = MapLock(path)
    try:
        for part in (path, *(path.with_name(path.name + end) for end in ("-wal", "-shm"))):
            part.unlink(missing_ok=True)
    except OSError as error:
        raise DatabaseError(f"{path} can't be replaced: {error.strerror}") from error
    finally:
        lock.release()
