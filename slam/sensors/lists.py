"""The text files of a TUM folder: one line an entry, stamp first, ``#`` for comments."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slam.errors import SourceError


@dataclass(frozen=True, slots=True)
class ImageList:
    """Stamps in seconds, strictly ascending, and the image file of each."""

    stamps: NDArray[np.float64]
    files: tuple[Path, ...]


def read_image_list(path: Path) -> ImageList:
    """Entries ``stamp filename`` of rgb.txt or depth.txt; file names are relative to the list's folder.

    Raises:
        SourceError: no such list, no entries, a line that can't be read, stamps that don't ascend, a missing file.
    """
    stamps: list[float] = []
    files: list[Path] = []
    for number, fields in _lines(path):
        if len(fields) < 2:
            raise SourceError(f"{path}:{number}: expected `stamp filename`, found {' '.join(fields)!r}")
        stamp = _number(path, number, fields[0], "a stamp in seconds")
        if stamps and stamp <= stamps[-1]:
            raise SourceError(
                f"{path}:{number}: stamp {fields[0]} does not come after the one before ({stamps[-1]:.6f}); "
                "sort the list by stamp and drop doubles"
            )
        stamps.append(stamp)
        files.append(path.parent / " ".join(fields[1:]))
        if not files[-1].is_file():
            raise SourceError(f"{path}:{number}: lists {files[-1]}, which does not exist")
    if not stamps:
        raise SourceError(f"{path}: lists no images; expected lines `stamp filename`")
    return ImageList(np.array(stamps), tuple(files))


def read_table(path: Path, columns: str) -> NDArray[np.float64]:
    """Rows of numbers, (N, C), such as groundtruth.txt; ``columns`` names them, stamp first, for messages.

    Raises:
        SourceError: the file can't be read, a row has too few or other than numbers, stamps go back in time.
    """
    width = len(columns.split())
    rows: list[list[float]] = []
    for number, fields in _lines(path):
        if len(fields) != width:
            raise SourceError(f"{path}:{number}: expected {width} numbers `{columns}`, found {len(fields)}")
        row = [_number(path, number, text, f"a number (of `{columns}`)") for text in fields]
        if rows and row[0] < rows[-1][0]:
            raise SourceError(f"{path}:{number}: stamp {fields[0]} lies before the line above; sort the file by stamp")
        rows.append(row)
    return np.array(rows, dtype=np.float64).reshape(-1, width)


def _lines(path: Path) -> Iterator[tuple[int, list[str]]]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise SourceError(f"{path}: no such file; a TUM folder has rgb.txt and depth.txt") from None
    except (OSError, UnicodeDecodeError) as error:
        raise SourceError(f"{path}: can't be read as text ({error})") from error
    for number, line in enumerate(text.splitlines(), start=1):
        fields = line.split("#", 1)[0].split()
        if fields:
            yield number, fields


def _number(path: Path, line: int, text: str, expected: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise SourceError(f"{path}:{line}: {text!r} is not {expected}")
    return value
