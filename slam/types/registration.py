"""What aligning two views comes to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Pose
from slam.types.refusal import Refusal


@dataclass(frozen=True, slots=True)
class IcpEvidence:
    """How well two scans agree.

    Attributes:
        ratio: points with a partner over the points of the larger scan.
        translation_m: length of the correction of the guess.
        rotation_rad: its angle.
        complexity: structural complexity of the plainer scan: 0 a plane, 1 surfaces in all directions.
        points: of the larger scan.
    """

    ratio: float
    translation_m: float
    rotation_rad: float
    complexity: float
    points: int


@dataclass(frozen=True, slots=True, eq=False)
class Registration:
    """Outcome of aligning two views: a transform with its evidence, or a refusal (then T_from_to is None).

    Attributes:
        T_from_to: (4, 4) pose of the second view in the first.
        covariance: (6, 6) x y z roll pitch yaw, m^2 and rad^2.
        matches: (M, 2) int rows of the features matched (from, to); none when only scans were compared; with optical
            flow both are the row of the first view's point.
        inliers: (M,) bool, which matches agree with the transform.
        refusal: the failed test when there is no transform.
        icp: what scans said, where they were compared.
    """

    T_from_to: Pose | None
    covariance: NDArray[np.float64]
    matches: NDArray[np.int32]
    inliers: NDArray[np.bool_]
    refusal: Refusal | None = None
    icp: IcpEvidence | None = None
