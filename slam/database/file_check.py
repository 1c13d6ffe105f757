"""What can be said of a map file without opening it, and which versions of RTAB-Map's schema are readable.

Nothing here opens a file that SQLite may have open in this process: on POSIX systems, closing any handle of a file
frees all the locks that the process has on it, and with them those of a writer at work.
"""

from __future__ import annotations

from pathlib import Path

from slam.errors import DatabaseError

#: The version that new files have: the oldest that carries all that slamdeck writes.
WRITTEN_VERSION = "0.20.0"
#: Major, minor and patch level.
Version = tuple[int, int, int]
#: First and last minor version of the schemas that can be read, and the first that can be written.
OLDEST, NEWEST, OLDEST_WRITTEN = (0, 5), (0, 23), (0, 18)
_HOW = "a map file of RTAB-Map or slamdeck is needed"


def check_file(path: Path) -> None:
    """Refuse what can't be a map file.

    Raises:
        DatabaseError: it is missing, a folder, empty, or can't be reached.
    """
    try:
        if path.is_dir():
            raise DatabaseError(f"{path} is a folder: {_HOW}")
        size = path.stat().st_size
    except FileNotFoundError as error:
        raise DatabaseError(f"{path} does not exist: {_HOW}") from error
    except OSError as error:
        raise DatabaseError(f"{path} can't be read: {error.strerror}") from error
    if not size:
        raise DatabaseError(f"{path} is empty: {_HOW}")


def size_with_log(path: Path) -> int:
    """Bytes of a file and of the log beside it."""
    return sum(part.stat().st_size for part in (path, path.with_name(path.name + "-wal")) if part.exists())


def check_version(version: str) -> Version:
    """The three numbers of a version that can be read.

    Raises:
        DatabaseError: the version is too new, too old, or none.
    """
    parts = version.split(".")
    if len(parts) < 2 or not all(part.isdecimal() for part in parts[:3]):
        raise DatabaseError(f"it has no version of RTAB-Map ({version!r} in its table Admin): {_HOW}")
    major, minor, patch = (int(part) for part in (*parts, "0")[:3])
    readable = f"versions {OLDEST[0]}.{OLDEST[1]} to {NEWEST[0]}.{NEWEST[1]} can be read"
    if (major, minor) > NEWEST:
        raise DatabaseError(f"it was written by RTAB-Map {version}, which is too new: {readable}")
    if (major, minor) < OLDEST:
        raise DatabaseError(f"it was written by RTAB-Map {version}, which is too old: {readable}")
    return major, minor, patch


def check_writable_version(version: str) -> None:
    """Refuse versions whose tables can be read, but not written.

    Raises:
        DatabaseError: the version is too new, too old, or none.
    """
    if not is_writable(check_version(version)):
        raise DatabaseError(
            f"it was written by RTAB-Map {version}: files before {OLDEST_WRITTEN[0]}.{OLDEST_WRITTEN[1]} can be read, "
            "but not changed; make a new map of it"
        )


def is_writable(version: Version) -> bool:
    """Whether the tables of a version are those that slamdeck writes."""
    return version[:2] >= OLDEST_WRITTEN
