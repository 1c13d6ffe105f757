"""Parameters of occupancy grids."""

from __future__ import annotations

from slam.params.registry import Effect, Group, param

_SESSION = Effect.SESSION


class GridGroup(Group):
    """Local occupancy grids from depth."""

    CellSize: float = param(0.05, "Side of a cell.", unit="m", ge=0.01, le=1, effect=_SESSION)
    DepthDecimation: int = param(4, "Use every n-th depth pixel.", unit="px", ge=1)
    RangeMin: float = param(0.0, "Nearest depth used.", unit="m", ge=0)
    RangeMax: float = param(5.0, "Farthest depth used; 0 is no limit.", unit="m", ge=0)
    MaxGroundAngle: float = param(45.0, "Steepest slope that counts as ground.", unit="deg", ge=0, le=90)
    MaxGroundHeight: float = param(0.0, "Highest ground; 0 is no limit.", unit="m")
    MaxObstacleHeight: float = param(0.0, "Highest obstacle; 0 is no limit.", unit="m")
    RayTracing: bool = param(True, "Mark cells between sensor and obstacle as free.")


class GridGlobalGroup(Group):
    """The global occupancy grid."""

    ProbHit: float = param(0.7, "Probability added by an obstacle.", ge=0.5, le=1, effect=_SESSION)
    ProbMiss: float = param(0.4, "Probability added by free space.", ge=0, le=0.5, effect=_SESSION)
    ProbClampingMin: float = param(0.1192, "Lowest probability kept.", ge=0, le=1, effect=_SESSION)
    ProbClampingMax: float = param(0.971, "Highest probability kept.", ge=0, le=1, effect=_SESSION)
    OccupancyThr: float = param(0.5, "Probability from which a cell is occupied.", ge=0, le=1)
    UpdateError: float = param(0.01, "Shift of a pose from which the grid is made anew.", unit="m", ge=0)
