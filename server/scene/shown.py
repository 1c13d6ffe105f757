"""What a 3D view is asked to show of a map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from server.browse.past import Then
from server.schemas import LoopWhatIf
from server.schemas.scene import Scene
from slam.geometry import Array
from slam.types import OccupancyGrid


@dataclass(frozen=True, slots=True, eq=False)
class OptimisedPath:
    """A step of an optimisation: ids, ascending, and their poses (N, 4, 4) ``T_map_base``."""

    ids: Sequence[int]
    T_map: Array


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """How, and what beside it.

    Attributes:
        state: layers, colours and selection.
        ghosts: loops and path with another threshold, or by a trial of other parameters.
        then: the moment that is shown; None for now.
        optimised: an optimisation on trial.
        floor: the floor plan of now; None where it is not to be seen.
        values: id -> number that nodes are coloured by; None for the colourings that need none.
    """

    state: Scene
    ghosts: LoopWhatIf | None = None
    then: Then | None = None
    optimised: OptimisedPath | None = None
    floor: OccupancyGrid | None = None
    values: Mapping[int, float] | None = None
