"""Parameters of map files: which can be taken over, and how two sets differ."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from slam.database import MapReader
from slam.errors import ParameterError
from slam.params import Params, Value, specs

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
