"""Finding nodes: by id, label, time, place and a few more, in one line.

Words are looked for in ids and labels; ``name:value`` asks for a property, and all parts must hold. Numbers and times
are one value, a range ``a..b`` (either end may be left out), or ``<b``, ``>a``, ``<=b``, ``>=a``. Times are UTC.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from server.browse.snapshot import Snapshot
from server.errors import QueryError
from slam.database import NodeTable
from slam.types import Tier

Mask = NDArray[np.bool_]
Bounds = tuple[float, float]

#: How near ``near`` is where no radius is given, metres.
RADIUS_M = 1.0
_DAY_S = 86_400.0
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?"
_PLACE = rf"(?:#\d+|{_NUMBER}[\s,]+{_NUMBER})(?:[\s,]+{_NUMBER}(?!\S))?"
_NEAR = re.compile(rf"\bnear:?\s*({_PLACE})(?!\S)", re.IGNORECASE)
_CLOCK = re.compile(r"(\d{1,2}):(\d{2})(?::(\d{2}(?:\.\d+)?))?")


@dataclass(frozen=True, slots=True, eq=False)
class _Nodes:
    """What is looked at: a table of nodes and the map that they are of."""

    snapshot: Snapshot
    table: NodeTable


def matching(snapshot: Snapshot, table: NodeTable, query: str) -> Mask:
    """Which rows (N,) of a table of nodes fit a query; all fit an empty one.

    Raises:
        QueryError: a part of the query is not understood.
    """
    nodes = _Nodes(snapshot, table)
    found = np.ones(len(table), dtype=bool)
    for near in _NEAR.finditer(query):
        found &= _near(nodes, near[1])
    for part in _NEAR.sub(" ", query).split():
        name, colon, value = part.partition(":")
        if name.lower() == "near":
            raise QueryError("near needs a place: near 1.2 3.4 or near #57, and a radius in metres where 1 won't do")
        if not colon:
            found &= _text(nodes, part)
        elif name.lower() in _PROPERTIES:
            found &= _PROPERTIES[name.lower()](nodes, value)
        else:
            known = ", ".join(f"{one}:" for one in _PROPERTIES)
            raise QueryError(f"{name}: is nothing that nodes are found by; there are {known} and near")
    return found


def _text(nodes: _Nodes, word: str) -> Mask:
    """Rows whose id or label holds a word."""
    wanted = word.lower()
    pairs = zip(nodes.table.ids.tolist(), nodes.table.labels, strict=True)
    return np.array([wanted in f"{node_id} {label or ''}".lower() for node_id, label in pairs], dtype=bool)


def _label(nodes: _Nodes, value: str) -> Mask:
    """Rows whose label holds a text; any label where the text is empty."""
    wanted = value.lower()
    return np.array([bool(label) and wanted in str(label).lower() for label in nodes.table.labels], dtype=bool)


def _ids(nodes: _Nodes, value: str) -> Mask:
    return _within(nodes.table.ids, _bounds(re.sub(r"^(\d+)-(\d+)$", r"\1..\2", value), _number, "id:100..200"))


def _stamp(nodes: _Nodes, value: str) -> Mask:
    return _within(nodes.table.stamps, _bounds(value, _number, "stamp:1305031100..1305031110"))


def _session(nodes: _Nodes, value: str) -> Mask:
    return _within(nodes.table.map_ids, _bounds(value, _number, "session:1"))


def _weight(nodes: _Nodes, value: str) -> Mask:
    return _within(nodes.table.weights, _bounds(value, _number, "weight:>2"))


def _loops(nodes: _Nodes, value: str) -> Mask:
    counts = nodes.snapshot.loop_counts
    each = np.array([counts[node_id] for node_id in nodes.table.ids.tolist()], dtype=np.int64)
    return _within(each, _bounds(value, _number, "loops:>0"))


def _memory(nodes: _Nodes, value: str) -> Mask:
    tiers = {str(tier): tier for tier in Tier}
    wanted = tiers.get(value.lower())
    if wanted is None:
        raise QueryError(f"memory:{value} is none of memory:{', memory:'.join(tiers)}")
    known = nodes.snapshot.tiers
    return np.array([known.get(node_id, Tier.LTM) == wanted for node_id in nodes.table.ids.tolist()], dtype=bool)


def _time(nodes: _Nodes, value: str) -> Mask:
    """Rows by date, or by time of day: a minute, a second, a day, or from the start of one to the end of another."""
    stamps = nodes.table.stamps
    example = "time:10:15, time:10:15..10:20:30 or time:2026-11-22T10:15"
    if all(end == "" or _CLOCK.fullmatch(end) for end in _ends(value)):
        first, last = _bounds(value, _clock, example)
        of_day = np.mod(stamps, _DAY_S)
        if first > last:
            # Over midnight.
            return np.asarray((of_day >= first) | (of_day <= last))
        return _within(of_day, (first, last))
    return _within(stamps, _bounds(value, _date, example))


def _near(nodes: _Nodes, value: str) -> Mask:
    """Rows within a radius of a place on the floor, or of a node, by the optimised poses."""
    first, *rest = re.split(r"[\s,]+", value.strip())
    poses = nodes.snapshot.poses
    if first.startswith("#"):
        centre = poses.get(int(first[1:]))
        if centre is None:
            raise QueryError(f"near {first}: the map has no node {first[1:]} with a pose")
        x, y, radius = float(centre[0, 3]), float(centre[1, 3]), rest
    else:
        x, y, radius = float(first), float(rest[0]), rest[1:]
    within = float(radius[0]) if radius else RADIUS_M
    if within <= 0:
        raise QueryError(f"near {value}: the radius is {within:g} m, and must be above 0")
    places = np.array([_place(poses.get(node_id)) for node_id in nodes.table.ids.tolist()]).reshape(-1, 2)
    return np.asarray(np.hypot(places[:, 0] - x, places[:, 1] - y) <= within)


def _place(T_map_base: NDArray[np.float64] | None) -> tuple[float, float]:
    return (np.nan, np.nan) if T_map_base is None else (float(T_map_base[0, 3]), float(T_map_base[1, 3]))


_PROPERTIES: Mapping[str, Callable[[_Nodes, str], Mask]] = MappingProxyType(
    {
        "id": _ids,
        "label": _label,
        "time": _time,
        "stamp": _stamp,
        "session": _session,
        "weight": _weight,
        "loops": _loops,
        "memory": _memory,
    }
)


def _within(values: NDArray[np.generic], bounds: Bounds) -> Mask:
    numbers = values.astype(np.float64)
    return np.asarray((numbers >= bounds[0]) & (numbers <= bounds[1]))


def _ends(value: str) -> list[str]:
    return re.sub(r"^[<>]=?", "", value).split("..", 1)


def _bounds(value: str, read: Callable[[str], Bounds], example: str) -> Bounds:
    """First and last of what a value, a range or a comparison means; ``read`` gives those of one value.

    Raises:
        QueryError: it is none of these; the message has an ``example``.
    """
    try:
        if compared := re.match(r"([<>])(=?)(.+)", value):
            first, last = read(compared[3])
            if compared[1] == "<":
                return -np.inf, last if compared[2] else float(np.nextafter(first, -np.inf))
            return first if compared[2] else float(np.nextafter(last, np.inf)), np.inf
        ends = _ends(value)
        if len(ends) == 1:
            return read(value)
        if not any(ends):
            raise ValueError(value)
        return read(ends[0])[0] if ends[0] else -np.inf, read(ends[1])[1] if ends[1] else np.inf
    except ValueError as error:
        raise QueryError(f"{value or 'nothing'} is not understood here; write for example {example}") from error


def _number(text: str) -> Bounds:
    if not re.fullmatch(_NUMBER, text, re.IGNORECASE):
        raise ValueError(text)
    return float(text), float(text)


def _clock(text: str) -> Bounds:
    """A minute or a second of the day, in seconds since midnight."""
    found = _CLOCK.fullmatch(text)
    if found is None or int(found[1]) > 23 or int(found[2]) > 59:
        raise ValueError(text)
    start = 3600.0 * int(found[1]) + 60.0 * int(found[2]) + float(found[3] or 0.0)
    return start, start + (60.0 if found[3] is None else 1.0) - 1e-6


def _date(text: str) -> Bounds:
    """A day, or a minute or second of one, in seconds since 1970."""
    read = datetime.fromisoformat(text)
    start = read if read.tzinfo else read.replace(tzinfo=UTC)
    whole = timedelta(hours=1) if "T" in text.upper() else timedelta(days=1)
    length = {0: whole, 1: timedelta(minutes=1)}.get(text.split("+")[0].count(":"), timedelta(seconds=1))
    return start.timestamp(), (start + length).timestamp() - 1e-6
