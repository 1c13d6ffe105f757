"""Rows that can't be understood: named by table, row and reason, so that all the others can still be shown."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

from slam.errors import DamagedRowError, DatabaseError
from slam.types import LinkType

Made = TypeVar("Made")
#: Characters of a row's name and of a reason: both may quote what the file holds.
_NAME, _REASON = 40, 300
_LARGEST_ID = 2**31 - 1
_LINK_TYPES = {int(kind): kind for kind in LinkType}
_SMALLEST_CELL_M, _LARGEST_CELL_M = 1e-3, 100.0


@dataclass(frozen=True, slots=True)
class Fault:
    """A row of a map file that can't be understood: its table, which row, and why."""

    table: str
    row: str
    reason: str


#: Where readers put the rows that they leave out; each once.
Faults = dict[Fault, None]


def each_sound(
    table: str, rows: Iterable[Any], make: Callable[[Any], Made], faults: Faults | None, columns: int = 1
) -> Iterator[Made]:
    """What ``make`` makes of every row; the first ``columns`` values name a row.

    Rows of which nothing can be made go to ``faults``.

    Raises:
        DamagedRowError: a row can't be understood and no ``faults`` are wanted.
    """
    for row in rows:
        try:
            made = make(row)
        except (DatabaseError, ValueError, TypeError, OverflowError, LookupError, RecursionError) as error:
            fault = Fault(table, "-".join(str(part)[:_NAME] for part in row[:columns]), reason_of(error))
            if faults is None:
                raise DamagedRowError(fault.table, fault.row, fault.reason) from error
            faults[fault] = None
        else:
            yield made


def reason_of(error: Exception) -> str:
    """One line of an error's text."""
    return (str(error).partition("\n")[0] or type(error).__name__)[:_REASON]


def node_id_of(value: object) -> int:
    """The value of a column as the id of a node.

    Raises:
        DatabaseError: it is none.
    """
    if not isinstance(value, int) or not 0 < value <= _LARGEST_ID:
        raise DatabaseError(f"{_quoted(value)} is no id of a node: those are whole numbers from 1 to {_LARGEST_ID}")
    return value


def whole_of(value: object, name: str) -> int:
    """The value of a column as a whole number of 32 bits, 0 for NULL; DatabaseError when it is none."""
    if value is None:
        return 0
    if not isinstance(value, int) or not -_LARGEST_ID <= value <= _LARGEST_ID:
        raise DatabaseError(f"{name} is {_quoted(value)}, which is no whole number of 32 bits")
    return value


def number_of(value: object, name: str) -> float:
    """The value of a column as a finite number, 0 for NULL; DatabaseError when it is none."""
    if value is None:
        return 0.0
    if not isinstance(value, int | float) or not -1e300 < value < 1e300:
        raise DatabaseError(f"{name} is {_quoted(value)}, which is no finite number")
    return float(value)


def cell_size_of(value: object, name: str) -> float:
    """The value of a column as the side of a grid's cells in metres; DatabaseError when no grid has such."""
    size = number_of(value, name)
    if not _SMALLEST_CELL_M <= size <= _LARGEST_CELL_M:
        raise DatabaseError(f"{name} is {size:g} m, and cells have {_SMALLEST_CELL_M:g} to {_LARGEST_CELL_M:g} m")
    return size


def link_type_of(value: object) -> LinkType:
    """The value of a column as the type of a link; DatabaseError when RTAB-Map has none of that number."""
    kind = _LINK_TYPES.get(value) if isinstance(value, int) else None
    if kind is None:
        raise DatabaseError(f"its type is {_quoted(value)}, which RTAB-Map does not know")
    return kind


def text_of(value: object, name: str) -> str:
    """The value of a column as text, empty for NULL; DatabaseError when it is none."""
    if value is None:
        return ""
    if not isinstance(value, str):
        raise DatabaseError(f"{name} is {_quoted(value)}, which is no text")
    return value


def blob_of(value: object, name: str, size: int) -> bytes | None:
    """The value of a column as a blob of so many bytes; None for NULL and for an empty one.

    Raises:
        DatabaseError: it is no blob, or one of another size.
    """
    if value is None or value == b"":
        return None
    if not isinstance(value, bytes) or len(value) != size:
        what = f"a blob of {len(value)} bytes" if isinstance(value, bytes) else _quoted(value)
        raise DatabaseError(f"{name} is {what}, not one of {size} bytes")
    return value


def _quoted(value: object) -> str:
    return f"a blob of {len(value)} bytes" if isinstance(value, bytes) else repr(value)[:_NAME]
