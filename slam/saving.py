"""Exported files appear whole or not at all."""

from __future__ import annotations

from pathlib import Path

from slam.errors import DatabaseError


def save(path: Path, content: bytes | str) -> None:
    """Write a file, replacing one of that name only once the new one is complete.

    Raises:
        DatabaseError: the folder is missing, not writable or full.
    """
    part = path.with_name(f".{path.name}.part")
    try:
        part.write_bytes(content.encode("utf-8") if isinstance(content, str) else content)
        part.replace(path)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise DatabaseError(f"{path}: can't be written ({error.strerror}); name a file in a writable folder") from error
