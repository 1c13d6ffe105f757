"""Parameters of map files: which can be taken over, and how two sets differ."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from slam.database import MapReader
from slam.errors import ParameterError
from slam.params import Params, Value, format_value, specs
from slam.params.ini import rtabmap_default

_TRUTH = {"true": "1", "false": "0"}
#: Groups of parameters that decide which key points are found in an image, and how they are described.
_DETECTORS = frozenset(["ALIKED", "BRIEF", "BRISK", "DISK", "FAST", "FREAK", "GFTT", "KAZE", "ORB", "SIFT", "SURF"])
_REGION = ("GridCols", "GridRows", "MaxDepth", "MinDepth", "RoiRatios")
_REFINED = ("SubPixEps", "SubPixIterations", "SubPixWinSize")
_EXTRACTION = frozenset(
    {
        "Kp/DetectorStrategy",
        "Vis/FeatureType",
        "Vis/MaxFeatures",
        *(f"{group}/{name}" for group in ("Kp", "Vis") for name in (*_REGION, *_REFINED)),
    }
)
#: Those that decide which words a node's key points become.
_WORDS = frozenset(
    ["Kp/IncrementalDictionary", "Kp/DictionaryPath", "Kp/MaxFeatures", "Kp/NndrRatio", "Kp/NewWordsComparedTogether"]
)


@dataclass(frozen=True, slots=True)
class Taken:
    """Parameters of a file: those in force, and those that slamdeck can't follow, with the reason."""

    params: Params
    refused: dict[str, str]


def taken(reader: MapReader) -> Taken:
    """The parameters that a file was made with, as far as slamdeck has them."""
    known, params, refused = {entry.name for entry in specs()}, Params(), dict[str, str]()
    for name, text in sorted(reader.parameters().items()):
        if name not in known:
            continue
        try:
            params = params.changed({name: text})
        except ParameterError as error:
            refused[name] = str(error)
    return Taken(params, refused)


def changes_features(changes: Mapping[str, Value], params: Params) -> list[str]:
    """Names among some changes that make other key points than those of ``params``."""
    changed = _changed(changes, params)
    return [name for name in changed if name in _EXTRACTION or name.partition("/")[0] in _DETECTORS]


def changes_words(changes: Mapping[str, Value], params: Params) -> bool:
    """Whether some changes make other words of the same key points than ``params``."""
    return not _WORDS.isdisjoint(_changed(changes, params))


def _changed(changes: Mapping[str, Value], params: Params) -> list[str]:
    after = params.changed(changes)
    return sorted(name for name in changes if after.get(name) != params.get(name))


@dataclass(frozen=True, slots=True)
class Difference:
    """A parameter that two files, or a file and the defaults, do not agree on.

    Attributes:
        name: full name.
        values: as text in each file, None where it does not have it.
        default: of slamdeck, None where only RTAB-Map has the parameter.
        rtabmap: default of RTAB-Map, None where it has no such parameter, empty where its builds differ.
    """

    name: str
    values: tuple[str | None, ...]
    default: str | None
    rtabmap: str | None


def differences(*files: Mapping[str, str]) -> list[Difference]:
    """Parameters that files don't agree on, by name; of one file those that differ from the defaults.

    What a file does not have is at its default: slamdeck's where slamdeck has the parameter, else RTAB-Map's.
    """
    own = {entry.name: format_value(entry.default) for entry in specs()}
    found = []
    for name in sorted(set().union(*files)):
        default, rtabmap = own.get(name), rtabmap_default(name)
        values = tuple(file.get(name) for file in files)
        usual = rtabmap if default is None else default
        compared = values if len(files) > 1 else (*values, None)
        in_force = [usual if value is None else value for value in compared]
        # Nothing can be said where one file lacks what only some builds of RTAB-Map have.
        known = [value for value in in_force if value is not None]
        if len(known) == len(in_force) and not all(same_value(known[0], other) for other in known[1:]):
            found.append(Difference(name, values, default, rtabmap))
    return found


def same_value(a: str, b: str) -> bool:
    """Whether two texts mean the same value: numbers and yes or no are compared as such."""
    try:
        return float(a) == float(b)
    except ValueError:
        return _TRUTH.get(a.strip().lower(), a) == _TRUTH.get(b.strip().lower(), b)
