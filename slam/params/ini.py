r"""RTAB-Map's parameter files: ``[Core]``, then lines such as ``Rtabmap\LoopThr=0.11``."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from importlib.resources import files
from pathlib import Path

from slam.errors import ParameterError
from slam.params.old_names import is_gone, todays
from slam.params.params import Params, specs

_SECTION = "Core"
#: Written by RTAB-Map beside the parameters.
_VERSION = "Version"
_NAMES_FILE = "rtabmap_names.txt"
_DEFAULTS_FILE = "rtabmap_defaults.txt"


@dataclass(frozen=True, slots=True)
class IniFile:
    """Values of a parameter file, as text by full name.

    Attributes:
        values: parameters that slamdeck has; each was checked, ``Params.changed`` takes them all.
        unused: parameters that only RTAB-Map has.
    """

    values: dict[str, str]
    unused: dict[str, str]


def known_unused(name: str) -> bool:
    """Whether RTAB-Map has a parameter of this full name and slamdeck doesn't."""
    return name in _rtabmap_names() and name not in _registered()


def rtabmap_default(name: str) -> str | None:
    """RTAB-Map's default of a full name as text: empty where its builds differ, None where it has no such parameter."""
    return _rtabmap_defaults().get(name, "" if name in _rtabmap_names() else None)


def read_ini(path: Path) -> IniFile:
    r"""Parameters of a file; groups and names are joined by a backslash (as Qt writes them) or by a slash.

    Names of older versions of RTAB-Map count as what they became. Sections other than ``[Core]`` hold settings of
    RTAB-Map's windows and are skipped; a file without sections is all parameters.

    Raises:
        ParameterError: with file and line; the file can't be read, a line is no ``name=value``, a name is unknown to
            both or given twice, a value has the wrong type or is out of bounds.
    """
    values: dict[str, str] = {}
    unused: dict[str, str] = {}
    for number, given, text in _entries(path):
        ((name, value),) = todays({given: text}).items()
        try:
            if name in values or name in unused:
                raise ParameterError(f"{name} is given twice; keep one of them")
            if known_unused(name) or is_gone(name):
                unused[name] = value
            elif name in _registered():
                Params().changed({name: value})
                values[name] = value
            else:
                raise ParameterError(f"neither RTAB-Map nor slamdeck has a parameter {name!r}{_hint(name)}")
        except ParameterError as error:
            raise ParameterError(f"{path}:{number}: {error}") from error
    return IniFile(values, unused)


def _entries(path: Path) -> Iterator[tuple[int, str, str]]:
    """Line number, full name and value of each parameter."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        raise ParameterError(f"{path}: can't be read ({reason}); expected an .ini file of RTAB-Map") from error
    section = _SECTION
    for number, raw in enumerate(text.splitlines(), start=1):
        line = raw.strip()
        if not line or line[0] in "#;":
            continue
        if line.startswith("[") and line.endswith("]"):
            section = line[1:-1].strip()
            continue
        if section != _SECTION:
            continue
        name, equals, value = (part.strip() for part in line.partition("="))
        if not equals or not name:
            raise ParameterError(f"{path}:{number}: {line!r} is not `Group\\Name=value`")
        if name != _VERSION:
            yield number, name.replace("\\", "/"), _unquoted(value)


def _unquoted(value: str) -> str:
    return value[1:-1] if len(value) > 1 and value[0] == value[-1] == '"' else value


def _hint(name: str) -> str:
    near = get_close_matches(name, [*_registered(), *_rtabmap_names()], n=3, cutoff=0.6)
    return f"; did you mean {' or '.join(dict.fromkeys(near))}?" if near else "; `slamdeck params` lists them all"


@cache
def _registered() -> frozenset[str]:
    return frozenset(spec.name for spec in specs())


@cache
def _rtabmap_names() -> frozenset[str]:
    text = files("slam.params").joinpath(_NAMES_FILE).read_text(encoding="utf-8")
    groups = (line.split(":", 1) for line in text.splitlines() if line and not line.startswith("#"))
    return frozenset(f"{group}/{name}" for group, names in groups for name in names.split())


@cache
def _rtabmap_defaults() -> dict[str, str]:
    text = files("slam.params").joinpath(_DEFAULTS_FILE).read_text(encoding="utf-8")
    return dict(line.split("=", 1) for line in text.splitlines() if line and not line.startswith("#"))
