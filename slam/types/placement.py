"""What people do to the poses of a map alone, with links and nodes as they are."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from slam.geometry import Pose, inverse
from slam.types.link import LinkType

#: Robust kernels by the names of ``Optimizer/RobustKernel``.
KernelName = Literal["none", "DCS", "Cauchy", "GNC"]
#: Where an optimisation begins: at poses put together along the links from the root, or at those of the map.
StartName = Literal["odometry", "map"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Manner:
    """How to optimise a graph otherwise than its parameters say.

    Attributes:
        root: the node held fixed; None for the one that the parameters choose.
        without: kinds of links that do not count.
        solver: instead of ``GTSAM/Optimizer``: 0 Levenberg-Marquardt, 1 Gauss-Newton, 2 Dogleg.
        kernel: instead of ``Optimizer/Robust`` and its kernel.
        start: where it begins.
    """

    root: int | None = None
    without: tuple[LinkType, ...] = ()
    solver: int | None = None
    kernel: KernelName | None = None
    start: StartName = "map"


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Placement:
    """All poses at once: as an optimisation has them, or the whole map moved as it is.

    Attributes:
        manner: how the graph is optimised; None where it is moved.
        step: the iteration whose poses are kept, 0 for the start; None for the last.
        T_new_old: (4, 4) takes the map from where it was to where it is; None where it is optimised.
    """

    manner: Manner | None = None
    step: int | None = None
    T_new_old: Pose | None = None

    def reversed(self) -> Placement:
        """What takes it back where the poses before are not kept: as the parameters say, or moved the other way."""
        if self.T_new_old is not None:
            return replace(self, T_new_old=inverse(self.T_new_old))
        return Placement(manner=Manner())
