"""Parameters under the names that older versions of RTAB-Map had for them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from importlib.resources import files

_FILE = "rtabmap_old_names.txt"
#: Stands for today's name where there is none.
_GONE = "-"
#: A decimal comma, which some locales wrote; RTAB-Map itself turns commas into dots.
_COMMA = re.compile(r"[-+]?\d+,\d+")
#: Switches of old that choose among several things today: true is the second of them, 1.
_CHOICES = frozenset({"Grid/FromDepth", "Icp/PM"})


def todays(values: Mapping[str, str]) -> dict[str, str]:
    """The same values by the names of today; where both an old and today's name are given, today's counts.

    Old names without a successor, and names that nobody knows, stay as they are.
    """
    found: dict[str, str] = {}
    for name, text in values.items():
        new = todays_name(name) or name
        if new == name or new not in values:
            found[new] = _value(name, text)
    return found


def todays_name(name: str) -> str | None:
    """Today's name of an old one; None where it is none that became another."""
    new = _old_names().get(name, _GONE)
    return None if new == _GONE else new


def is_gone(name: str) -> bool:
    """Whether RTAB-Map once had a parameter of this name, and has nothing that its value fits today."""
    return _old_names().get(name) == _GONE


def _value(name: str, text: str) -> str:
    if name in _CHOICES:
        return {"true": "1", "false": "0"}.get(text.strip().lower(), text)
    return text.replace(",", ".") if _COMMA.fullmatch(text.strip()) else text


@cache
def _old_names() -> Mapping[str, str]:
    text = files("slam.params").joinpath(_FILE).read_text(encoding="utf-8")
    lines = (line.split(":", 1) for line in text.splitlines() if line and not line.startswith("#"))
    return {old: new for new, olds in lines for old in olds.split()}
