"""What a node of a map file has besides images, key points and cloud."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

#: Kinds of environmental sensors: what they measure and in which unit, by RTAB-Map's number.
ENVIRONMENT: Mapping[int, tuple[str, str]] = MappingProxyType(
    {
        0: ("undefined", ""),
        1: ("Wi-Fi signal", "dBm"),
        2: ("temperature", "°C"),
        3: ("air pressure", "hPa"),
        4: ("light", "lx"),
        5: ("relative humidity", "%"),
    }
)


@dataclass(frozen=True, slots=True)
class Gps:
    """A position on the earth: degrees, metres, seconds; ``bearing`` in degrees clockwise from north."""

    stamp: float
    longitude: float
    latitude: float
    altitude: float
    error: float
    bearing: float


@dataclass(frozen=True, slots=True)
class EnvironmentValue:
    """What a sensor of a kind (``ENVIRONMENT``, or a custom number from 100 on) measured at a moment, seconds."""

    kind: int
    value: float
    stamp: float

    @property
    def name(self) -> str:
        """What was measured."""
        return ENVIRONMENT.get(self.kind, (f"custom {self.kind}", ""))[0]

    @property
    def unit(self) -> str:
        """Its unit; empty where none is known."""
        return ENVIRONMENT.get(self.kind, ("", ""))[1]


@dataclass(frozen=True, slots=True, eq=False)
class GlobalDescriptor:
    """One vector for a whole image: RTAB-Map's type (1: compared by dot product) and the values (N,)."""

    kind: int
    values: NDArray[np.generic]


@dataclass(frozen=True, slots=True, eq=False)
class NodeSensors:
    """Sensor data of a node that is neither image nor cloud.

    Attributes:
        velocity: (6,) metres and radians a second, x y z roll pitch yaw of the base; None where unknown.
        gps: None where there is none.
        environment: of thermometers and the like.
        descriptors: of the whole image.
        user_data: the matrix that a program attached; None where there is none.
    """

    velocity: NDArray[np.float32] | None = None
    gps: Gps | None = None
    environment: tuple[EnvironmentValue, ...] = ()
    descriptors: tuple[GlobalDescriptor, ...] = field(default=())
    user_data: NDArray[np.generic] | None = None


def text_in(matrix: NDArray[np.generic] | None) -> str | None:
    """The text that a matrix of one row of signed bytes holds; None where it holds none."""
    if matrix is None or matrix.dtype != np.int8 or len(matrix) != 1:
        return None
    raw = matrix.tobytes().rstrip(b"\0")
    try:
        text = raw.decode()
    except UnicodeDecodeError:
        return None
    return text if all(mark.isprintable() or mark in "\n\r\t" for mark in text) else None
