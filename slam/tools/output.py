"""A new map file that appears under its name only when it is finished."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from slam.database.lock import locked
from slam.errors import DatabaseError


@contextmanager
def new_map(path: Path, inputs: Sequence[Path] = (), *, force: bool = False) -> Iterator[Path]:
    """A name in the same folder to make the map under; it gets ``path`` when the block has ended well.

    A process that is killed leaves nothing under ``path``; what it had made is removed by the next one.

    Args:
        path: the map file to make.
        inputs: files it is made of, which it must not replace.
        force: replace a file of that name.

    Raises:
        DatabaseError: the name is taken, does not end in .db, or is that of an input; the folder is missing.
        MapBusyError: somebody else is making or writing it.
    """
    check_target(path, inputs, force=force)
    part = path.with_name(f".{path.name}.part")
    with locked(path) as lock:
        try:
            _remove(part)
            yield part
            # What another process made there meanwhile is nobody's to replace without being told.
            check_target(path, inputs, force=force)
            _remove_logs(path)
            part.replace(path)
        except OSError as error:
            raise DatabaseError(f"{path} can't be made: {error.strerror}") from error
        finally:
            _remove(part)
            lock.release()


def check_target(path: Path, inputs: Sequence[Path] = (), *, force: bool = False) -> None:
    """Raises DatabaseError where no map may be made, as ``new_map`` does."""
    if path.suffix != ".db":
        raise DatabaseError(f"{path}: a map file's name ends in .db, as in {path.stem or 'map'}.db")
    if not path.parent.is_dir():
        raise DatabaseError(f"{path} can't be made: the folder {path.parent} does not exist")
    if not path.exists():
        return
    if any(one.exists() and path.samefile(one) for one in inputs):
        raise DatabaseError(f"{path} is read and stays as it is: choose another name for the new map")
    if not force:
        raise DatabaseError(f"{path} exists already: choose another name, or replace it with --force")
    if not path.is_file():
        raise DatabaseError(f"{path} is no file that could be replaced: name a map file")


def _remove(path: Path) -> None:
    path.unlink(missing_ok=True)
    _remove_logs(path)
    for end in (".lock", ".new"):
        path.with_name(path.name + end).unlink(missing_ok=True)


def _remove_logs(path: Path) -> None:
    """A log of the file that was there would be taken for the new one's."""
    for end in ("-wal", "-shm", "-journal"):
        path.with_name(path.name + end).unlink(missing_ok=True)
