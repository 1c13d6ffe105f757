"""Parameters of pose graph optimisation."""

from __future__ import annotations

from typing import Literal

from pydantic import field_validator

from slam.params.registry import Group, param


class OptimizerGroup(Group):
    """Pose graph optimisation."""

    Strategy: int = param(2, "Library that optimises: 2 GTSAM.", ge=2, le=2)
    Iterations: int = param(20, "Most iterations.", ge=1)
    Epsilon: float = param(1e-5, "Relative decrease of the error at which to stop.", ge=0)
    VarianceIgnored: bool = param(False, "All links count the same: identity instead of their information.")
    Robust: bool = param(False, "Loops that the others contradict count less (switchable constraints).")
    RobustKernel: Literal["DCS", "Cauchy", "GNC"] = param(
        "DCS",
        "How Optimizer/Robust weighs loops: DCS (switchable constraints in closed form), Cauchy, "
        "or GNC (finds false loops from any start, slow, always by Levenberg-Marquardt).",
    )
    GravitySigma: float = param(
        0.3, "Sigma of the direction of gravity at nodes that know it; 0 is off.", unit="rad", ge=0
    )
    PriorsIgnored: bool = param(True, "Leave out what is known of poses from outside (GPS, PosePrior links).")
    LandmarksIgnored: bool = param(False, "Leave out landmarks.")

    @field_validator("Strategy", mode="before")
    @classmethod
    def _is_built_in(cls, value: object) -> object:
        others = {"0": "TORO", "1": "g2o", "3": "Ceres"}
        if str(value) in others:
            raise ValueError(f"2 (GTSAM): slamdeck has no {others[str(value)]}")
        return value


class GTSAMGroup(Group):
    """How GTSAM optimises."""

    Optimizer: int = param(0, "Method: 0 Levenberg-Marquardt, 1 Gauss-Newton, 2 Dogleg.", ge=0, le=2)
    Incremental: bool = param(
        False, "Go on from the last optimisation (iSAM2), by Dogleg if that is chosen, else by Gauss-Newton."
    )
    IncRelinearizeThreshold: float = param(
        0.01, "iSAM2 linearises anew the poses that moved more than this.", unit="m or rad", ge=0
    )
    IncRelinearizeSkip: int = param(1, "iSAM2 looks for such poses every so many steps.", unit="steps", ge=1)
