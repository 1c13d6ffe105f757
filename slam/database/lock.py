"""One writer for each map file: a lock held on ``<file>.lock`` as long as the writer lives, whatever ends it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

from slam.errors import DatabaseError, MapBusyError


@contextmanager
def locked(map_path: Path) -> Iterator[MapLock]:
    """The lock of a map file for as long as its holder likes; it is freed here only when what follows fails."""
    with ExitStack() as undo:
        lock = MapLock(map_path)
        undo.callback(lock.release)
        yield lock
        undo.pop_all()


class MapLock:
    """The lock of one map file, taken at once or refused. The operating system frees it when the process dies."""

    def __init__(self, map_path: Path) -> None:
        self.path = map_path.with_name(map_path.name + ".lock")
        self._lock = FileLock(self.path, thread_local=False)
        try:
            self._lock.acquire(blocking=False)
        except Timeout:
            raise MapBusyError(
                f"{map_path} is being written by {self._holder()}: stop it first, or wait until it ends"
            ) from None
        except OSError as error:
            raise DatabaseError(
                f"{map_path} can't be written: no lock at {self.path} ({error.strerror}); the folder must be writable"
            ) from error
        self._sign()

    def release(self) -> None:
        """Free the lock and remove its file (while it is held, so that nobody's else is removed)."""
        if self._lock.is_locked:
            self.path.unlink(missing_ok=True)
            self._lock.release()

    def _sign(self) -> None:
        try:
            self.path.write_text(f"{os.getpid()}\n", encoding="ascii")
        except OSError as error:
            self.release()
            raise DatabaseError(f"the lock {self.path} can't be written: {error.strerror}") from error

    def _holder(self) -> str:
        text = ""
        with suppress(OSError, UnicodeDecodeError):
            text = self.path.read_text(encoding="ascii").strip()
        return f"process {text} (lock {self.path})" if text.isdecimal() else f"another process (lock {self.path})"
