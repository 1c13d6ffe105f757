"""What can be said of a map file before SQLite opens it, and which versions of RTAB-Map's schema are readable."""

from __future__ import annotations

from pathlib import Path

from slam.errors import DatabaseError

#: The version that new files have: the oldest that carries all that slamdeck writes.
WRITTEN_VERSION = "0.20.0"
#: First and last minor version of the schemas that can be read.
OLDEST, NEWEST = (0, 18), (0, 23)
_MAGIC = b"SQLite format 3\0"
_HEADER_SIZE = 100
_HOW = "a map file of RTAB-Map or slamdeck is needed"


def check_file(path: Path) -> None:
    """Refuse what is no SQLite file.

    Raises:
        DatabaseError: it is missing, a folder, empty, unreadable, of another kind, or shorter than it says.
    """
    if path.is_dir():
        raise DatabaseError(f"{path} is a folder: {_HOW}")
    header, size = _read_header(path)
    if not size:
        raise DatabaseError(f"{path} is empty: {_HOW}")
    if not header.startswith(_MAGIC) or len(header) < _HEADER_SIZE:
        raise DatabaseError(f"{path} is not an SQLite file: {_HOW}")
    page = int.from_bytes(header[16:18], "big")
    expected = (65536 if page == 1 else page) * int.from_bytes(header[28:32], "big")
    # The page count holds only when its change counter equals the file's; beside a log the file may still be short.
    counted = header[24:28] == header[92:96]
    if counted and size < expected and not has_log(path):
        raise DatabaseError(f"{path} is cut off: it has {size} of {expected} bytes; copy it again from its source")


def has_log(path: Path) -> bool:
    """Whether a write-ahead log with content lies beside the file: its writer is at work, or was killed."""
    log = path.with_name(path.name + "-wal")
    return log.exists() and log.stat().st_size > 0


def is_write_ahead(path: Path) -> bool:
    """Whether the file is in WAL mode, by the format bytes of its header."""
    return _read_header(path)[0][18:20] == b"\2\2"


def check_version(version: str) -> None:
    """Refuse versions whose columns are not known.

    Raises:
        DatabaseError: the version is too new, too old, or none.
    """
    parts = version.split(".")
    if len(parts) < 2 or not all(part.isdecimal() for part in parts[:2]):
        raise DatabaseError(f"it has no version of RTAB-Map ({version!r} in its table Admin): {_HOW}")
    minor = (int(parts[0]), int(parts[1]))
    readable = f"versions {OLDEST[0]}.{OLDEST[1]} to {NEWEST[0]}.{NEWEST[1]} can be read"
    if minor > NEWEST:
        raise DatabaseError(f"it was written by RTAB-Map {version}, which is too new: {readable}")
    if minor < OLDEST:
        raise DatabaseError(
            f"it was written by RTAB-Map {version}, which is too old: {readable}; update it with rtabmap-reprocess"
        )


def _read_header(path: Path) -> tuple[bytes, int]:
    try:
        with path.open("rb") as file:
            return file.read(_HEADER_SIZE), path.stat().st_size
    except FileNotFoundError as error:
        raise DatabaseError(f"{path} does not exist: {_HOW}") from error
    except OSError as error:
        raise DatabaseError(f"{path} can't be read: {error.strerror}") from error
