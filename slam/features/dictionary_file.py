"""The words of ``Kp/DictionaryPath``: RTAB-Map's text, or the dictionary of a map."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from slam.database import MapReader, WordRows
from slam.errors import DatabaseError, ParameterError
from slam.features.dictionary import Dictionary
from slam.features.fixed_dictionary import FixedDictionary
from slam.params import Params

_NAME = "Kp/DictionaryPath"
_LONGEST = 1000


def open_dictionary(params: Params, *, seed: int, map_path: Path | None = None) -> Dictionary | FixedDictionary:
    """The dictionary that ``Kp/IncrementalDictionary`` asks for.

    Args:
        params: the Kp group is read.
        seed: of the index.
        map_path: the file that new words go to.

    Raises:
        ParameterError: a fixed dictionary can't be read, or has no words.
    """
    if params.Kp.IncrementalDictionary:
        return Dictionary(seed=seed)
    if not params.Kp.DictionaryPath:
        raise ParameterError(f"Kp/IncrementalDictionary=false needs {_NAME}: a text file of words, or a map")
    words = read_dictionary(Path(params.Kp.DictionaryPath))
    stored = () if map_path is None else MapReader(map_path).words().ids.tolist()
    return FixedDictionary(words, stored=stored, seed=seed)


def read_dictionary(path: Path) -> WordRows:
    """Words of a file: of a map if its name ends with ``.db``, else of RTAB-Map's text.

    The text's first line ends with the number of numbers of a word; each other line is an id and that many numbers.

    Raises:
        ParameterError: the file can't be read, a line is wrong, an id comes twice, or there is no word.
    """
    try:
        words = MapReader(path).words() if path.suffix == ".db" else _read_text(path)
    except (DatabaseError, OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise ParameterError(f"{_NAME}={path}: can't be read ({reason})") from error
    if len(words) == 0:
        raise ParameterError(f"{_NAME}={path}: has no words")
    return words


def _read_text(path: Path) -> WordRows:
    with path.open(encoding="utf-8") as lines:
        digits = re.search(r"\d+", next(lines, ""))
        width = int(digits.group()) if digits else 0
        if not 0 < width <= _LONGEST:
            raise ParameterError(
                f"{_NAME}={path}:1: the first line must end with the numbers of a word, 1 to {_LONGEST}, "
                "as in `WordID Descriptors...64`"
            )
        rows = dict(_rows(path, lines, width))
    ids = np.array(sorted(rows), np.int32)
    return WordRows(ids, np.array([rows[i] for i in ids.tolist()], np.float32).reshape(-1, width))


def _rows(path: Path, lines: Iterator[str], width: int) -> Iterator[tuple[int, list[float]]]:
    seen: set[int] = set()
    for number, line in enumerate(lines, start=2):
        parts = line.split()
        if not parts:
            continue
        try:
            word, values = int(parts[0]), [float(part) for part in parts[1:]]
        except ValueError:
            word, values = 0, []
        if word <= 0 or word in seen or len(values) != width or not np.isfinite(values).all():
            raise ParameterError(
                f"{_NAME}={path}:{number}: must be a word's own id, above 0, and {width} numbers with spaces between"
            )
        seen.add(word)
        yield word, values
