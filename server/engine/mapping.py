"""An engine on a new map file, closed in order whatever happens."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from slam.database import MapWriter
from slam.database.lock import MapLock
from slam.errors import DatabaseError
from slam.features.files import check_files
from slam.params import Params
from slam.slam import Slam


@contextmanager
def engine_on_new_map(
    path: Path, params: Params, *, seed: int, source: str, overwrite: bool
) -> Iterator[tuple[Slam, MapWriter]]:
    """An engine that writes a new map, and the writer; afterwards the session is ended and the file is one plain file.

    Raises:
        ParameterError: a network or dictionary that the parameters name can't be read; then no file is touched.
        DatabaseError: the file exists and may not be replaced, is no map, or can't be made.
        MapBusyError: somebody writes it.
    """
    check_files(params)
    if overwrite and path.exists():
        _remove(path)
    with MapWriter.create(path, params, seed=seed, source=source) as writer:
        slam = Slam(params, writer, seed=seed, source=source)
        try:
            yield slam, writer
        finally:
            slam.close()


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
