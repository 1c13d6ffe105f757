"""The pages of an SQLite file read one by one, without SQLite, so that a damaged one costs no other.

The format: https://www.sqlite.org/fileformat2.html.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from mmap import mmap

_MAGIC = b"SQLite format 3\0"
_USUAL_SIZE = 4096
_FILE_HEADER = 100
LEAF, INTERIOR, INDEX_LEAF, INDEX_INTERIOR = 0x0D, 0x05, 0x0A, 0x02
#: Bytes of the integers of the serial types 0 to 6.
_INTEGERS = (0, 1, 2, 3, 4, 6, 8)


#: First byte and end of what is gone in a row.
Hole = tuple[int, int]


class Lost(Enum):
    """Stands for a value whose page is gone."""

    LOST = 0


Value = int | float | str | bytes | None | Lost


class PageError(ValueError):
    """A page is not what it should be."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A row: its number (0 in a table without row numbers) and values."""

    rowid: int
    values: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class Gap:
    """Row numbers above ``after`` up to ``last`` (None: all) whose page is gone."""

    after: int
    last: int | None


class Pages:
    """A file's pages, numbered from 1."""

    def __init__(self, content: bytes | mmap) -> None:
        self._content = content
        self.is_sqlite = content[:16] == _MAGIC
        size = int.from_bytes(content[16:18], "big")
        size = 65536 if size == 1 else size
        sound = self.is_sqlite and size >= 512 and size & (size - 1) == 0
        self._size = size if sound else _USUAL_SIZE
        self._usable = self._size - (content[20] if sound else 0)
        self.count = len(content) // self._size

    def free(self) -> set[int]:
        """Pages that hold nothing any more."""
        found: set[int] = set()
        trunk = int.from_bytes(self._content[32:36], "big")
        while 0 < trunk <= self.count and trunk not in found:
            found.add(trunk)
            page = self._page(trunk)
            following, held = struct.unpack_from(">II", page)
            found.update(struct.unpack_from(f">{min(held, self._size // 4 - 2)}I", page, 8))
            trunk = following
        return found

    def kind(self, number: int) -> int:
        """First byte of a page's own header, 0 for a page that is not there."""
        return self._page(number)[self._start(number)] if 0 < number <= self.count else 0

    def leaves(self, root: int, seen: set[int]) -> Iterator[int | Gap]:
        """Pages of a tree that hold rows, in the order of their rows, and the gaps where such are gone."""
        stack: list[tuple[int, int, int | None]] = [(root, 0, None)]
        while stack:
            number, after, last = stack.pop()
            kind = self.kind(number)
            if number in seen or kind not in (LEAF, INTERIOR, INDEX_LEAF, INDEX_INTERIOR):
                yield Gap(after, last)
                continue
            seen.add(number)
            if kind != INTERIOR:
                yield number
            if kind in (INTERIOR, INDEX_INTERIOR):
                try:
                    stack += reversed(self._children(number, kind, after, last))
                except (PageError, struct.error, IndexError):
                    yield Gap(after, last)

    def cells(self, number: int) -> Iterator[Cell | None]:
        """Rows of a page; None for one that can't be read."""
        page, kind = self._page(number), self.kind(number)
        try:
            places = self._places(page, number, kind)
        except (PageError, struct.error):
            yield None
            return
        for place in places:
            try:
                yield self._cell(page, place, kind)
            except (PageError, struct.error, IndexError):
                yield None

    def _page(self, number: int) -> bytes:
        return self._content[(number - 1) * self._size : number * self._size]

    def _start(self, number: int) -> int:
        return _FILE_HEADER if number == 1 else 0

    def _places(self, page: bytes, number: int, kind: int) -> tuple[int, ...]:
        start = self._start(number)
        count = int.from_bytes(page[start + 3 : start + 5], "big")
        header = start + (12 if kind in (INTERIOR, INDEX_INTERIOR) else 8)
        if header + 2 * count > self._usable:
            raise PageError("more cells than the page has room for")
        return struct.unpack_from(f">{count}H", page, header)

    def _children(self, number: int, kind: int, after: int, last: int | None) -> list[tuple[int, int, int | None]]:
        page, start, found = self._page(number), self._start(number), []
        low = after
        for place in self._places(page, number, kind):
            child = int.from_bytes(page[place : place + 4], "big")
            key = varint(page, place + 4)[0] if kind == INTERIOR else low
            found.append((child, low, key))
            low = key
        return [*found, (int.from_bytes(page[start + 8 : start + 12], "big"), low, last)]

    def _cell(self, page: bytes, place: int, kind: int) -> Cell:
        at, rowid = place + (4 if kind == INDEX_INTERIOR else 0), 0
        size, at = varint(page, at)
        if kind == LEAF:
            rowid, at = varint(page, at)
            rowid -= (rowid >> 63) << 64
        payload, holes = self._payload(page, at, size, kind)
        return Cell(rowid, record(payload, holes))

    def _payload(self, page: bytes, at: int, size: int, kind: int) -> tuple[bytes, list[Hole]]:
        """Content of a cell as far as its overflow pages are there, and the holes in it."""
        usable = self._usable
        most = usable - 35 if kind == LEAF else (usable - 12) * 64 // 255 - 23
        if size <= most:
            return page[at : at + size], []
        least = (usable - 12) * 32 // 255 - 23
        local = least + (size - least) % (usable - 4)
        local = local if local <= most else least
        first = int.from_bytes(page[at + local : at + local + 4], "big")
        content, holes = self._overflow(first, size - local)
        return page[at : at + local] + content, [(start + local, end + local) for start, end in holes]

    def _overflow(self, number: int, size: int) -> tuple[bytes, list[Hole]]:
        """The rest of a long value.

        Such pages mostly follow each other: where one is gone the next one is tried, and believed when the chain then
        ends where it must; else the value is cut off.
        """
        room = self._usable - 4
        parts: list[bytes] = []
        holes: list[Hole] = []
        seen: set[int] = set()
        sure = 0
        for start in range(0, size, room):
            if not 0 < number <= self.count or number in seen:
                return b"".join(parts)[:sure], []
            seen.add(number)
            page, end = self._page(number), min(start + room, size)
            following, is_last = int.from_bytes(page[:4], "big"), end == size
            parts.append(page[4 : 4 + end - start])
            if (is_last and following) or (not is_last and not self._can_follow(following)):
                if is_last:
                    return b"".join(parts)[:sure], []
                holes.append((start, end))
                following = number + 1
            elif not holes:
                sure = end
            number = following
        return b"".join(parts), holes

    def _can_follow(self, number: int) -> bool:
        return 0 < number <= self.count


def varint(content: bytes, at: int) -> tuple[int, int]:
    """A number of one to nine bytes, and the place after it; IndexError where the content ends before."""
    value = 0
    for k in range(8):
        byte = content[at + k]
        value = value << 7 | byte & 0x7F
        if byte < 0x80:
            return value, at + k + 1
    return value << 8 | content[at + 8], at + 9


def record(payload: bytes, holes: Sequence[Hole] = ()) -> tuple[Value, ...]:
    """The values of a row; those that lie in a hole or beyond the payload's end are lost."""
    end, at = varint(payload, 0)
    if end > len(payload) or any(start < end for start, _ in holes):
        raise PageError("a row's header is cut off")
    types = []
    while at < end:
        kind, at = varint(payload, at)
        types.append(kind)
    values: list[Value] = []
    for kind in types:
        value, after = _value(payload, at, kind)
        values.append(Lost.LOST if any(start < after and at < stop for start, stop in holes) else value)
        at = after
    return tuple(values)


def _value(payload: bytes, at: int, kind: int) -> tuple[Value, int]:
    if kind in (10, 11):
        raise PageError(f"type {kind} is none of SQLite's")
    if kind in (0, 8, 9):
        return (None if kind == 0 else kind - 8), at
    size = _INTEGERS[kind] if kind < 7 else 8 if kind == 7 else (kind - 12) // 2
    part, after = payload[at : at + size], at + size
    if len(part) < size:
        return Lost.LOST, after
    if kind < 7:
        return int.from_bytes(part, "big", signed=True), after
    if kind == 7:
        return float(struct.unpack(">d", part)[0]), after
    return (part.decode("utf-8", "replace") if kind % 2 else bytes(part)), after
