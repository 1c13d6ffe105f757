"""Flat things in the world, before they become arrays."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from slam.sensors.tour.paint.canvas import Painter

Vector = tuple[float, float, float]
Facing = Literal["north", "south", "east", "west", "up", "down"]


@dataclass(frozen=True, slots=True, eq=False)
class Face:
    """A painted rectangle: top left corner, edge to the right and edge downwards as seen from its front, in metres.

    Attributes:
        origin: top left corner in the world.
        right: edge vector.
        down: edge vector.
        paint: its painter.
        pixels_per_m: resolution of its texture.
        glows: whether it shines by itself (lamps, screens, windows) instead of being lit.
    """

    origin: Vector
    right: Vector
    down: Vector
    paint: Painter
    pixels_per_m: float
    glows: bool = False


@dataclass(slots=True)
class Plan:
    """What stands where: faces to see and blocks (low corner, high corner) that cast shadows."""

    faces: list[Face] = field(default_factory=list)
    blocks: list[tuple[Vector, Vector]] = field(default_factory=list)

    def panel(
        self,
        facing: Facing,
        corner: Vector,
        size: tuple[float, float],
        paint: Painter,
        pixels_per_m: float = 160.0,
        glows: bool = False,
    ) -> None:
        """A rectangle from its lowest corner (smallest x, y, z); size is its extent along the floor and upwards.

        Panels that face up or down have their size along x and y; their texture reads with north up.
        """
        x, y, z = corner
        a, b = size
        origin, right, down = {
            "south": ((x, y, z + b), (a, 0.0, 0.0), (0.0, 0.0, -b)),
            "north": ((x + a, y, z + b), (-a, 0.0, 0.0), (0.0, 0.0, -b)),
            "east": ((x, y, z + b), (0.0, a, 0.0), (0.0, 0.0, -b)),
            "west": ((x, y + a, z + b), (0.0, -a, 0.0), (0.0, 0.0, -b)),
            "up": ((x, y + b, z), (a, 0.0, 0.0), (0.0, -b, 0.0)),
            "down": ((x, y, z), (a, 0.0, 0.0), (0.0, b, 0.0)),
        }[facing]
        self.faces.append(Face(origin, right, down, paint, pixels_per_m, glows))

    def block(
        self,
        corner: Vector,
        size: Vector,
        paint: Painter,
        pixels_per_m: float = 160.0,
        glows: bool = False,
        **sides: Painter,
    ) -> None:
        """A box from its low corner; ``paint`` is for all sides but those given by name (``north=...``, ``up=...``)."""
        (x, y, z), (dx, dy, dz) = corner, size
        places: dict[Facing, tuple[Vector, tuple[float, float]]] = {
            "south": ((x, y, z), (dx, dz)),
            "north": ((x, y + dy, z), (dx, dz)),
            "west": ((x, y, z), (dy, dz)),
            "east": ((x + dx, y, z), (dy, dz)),
            "up": ((x, y, z + dz), (dx, dy)),
        }
        if z > 0:
            places["down"] = ((x, y, z), (dx, dy))
        for facing, (low, extent) in places.items():
            own = facing in sides
            self.panel(facing, low, extent, sides.get(facing, paint), pixels_per_m, glows and own)
        self.blocks.append((corner, (x + dx, y + dy, z + dz)))
