"""Options of the rendered tour, as text behind ``tour:``."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

from slam.errors import SourceError

#: Smallest and largest value of each option.
_BOUNDS: dict[str, tuple[float, float]] = {
    "laps": (1, 20),
    "fps": (1, 60),
    "seed": (0, 2**31 - 1),
    "width": (64, 1920),
    "height": (48, 1440),
    "frames": (1, 100_000),
    "speed": (0.2, 1.5),
}


@dataclass(frozen=True, slots=True)
class TourOptions:
    """What to walk and how to film it.

    Attributes:
        laps: rounds through the flat; each is a little beside the one before.
        fps: frames per second of the stamps.
        seed: of the small motions and of the sensor's noise; the flat is always the same.
        width: pixels.
        height: pixels.
        frames: stop after this many; 0 is all of the laps.
        speed: metres per second.
    """

    laps: int = 2
    fps: float = 15.0
    seed: int = 0
    width: int = 640
    height: int = 480
    frames: int = 0
    speed: float = 0.8

    @classmethod
    def parse(cls, text: str) -> TourOptions:
        """Options from text such as ``laps=2,fps=15``; empty text gives the defaults.

        Raises:
            SourceError: an option is unknown, given twice, not a number, or out of bounds.
        """
        values: dict[str, Any] = {}
        for entry in filter(None, text.split(",")):
            name, _, value = (part.strip() for part in entry.partition("="))
            if name not in _BOUNDS:
                raise SourceError(f"tour:{text}: no option {name!r}; there are {', '.join(_BOUNDS)}")
            if name in values:
                raise SourceError(f"tour:{text}: {name} is given twice")
            values[name] = _number(text, name, value)
        return replace(cls(), **values)

    def __str__(self) -> str:
        """The address that gives these options; what is as usual is left out."""
        given = [f"{f.name}={getattr(self, f.name):g}" for f in fields(self) if getattr(self, f.name) != f.default]
        return "tour:" + ",".join(given)


def _number(text: str, name: str, value: str) -> float | int:
    low, high = _BOUNDS[name]
    kind = type(getattr(TourOptions(), name))
    try:
        number: float | int = kind(value)
    except ValueError:
        number = float("nan")
    if not low <= number <= high:
        expected = "a whole number" if kind is int else "a number"
        raise SourceError(f"tour:{text}: {name} is {value!r}; expected {expected} from {low:g} to {high:g}")
    return number
