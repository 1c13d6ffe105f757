"""Parameters of registering two views, by images and by clouds."""

from __future__ import annotations

from pydantic import field_validator

from slam.params.feature_types import CHOICES, checked_feature_type
from slam.params.registry import Effect, Group, param
from slam.params.roi import checked_ratios

_SESSION = Effect.SESSION
_NO_BORDER = "0.0 0.0 0.0 0.0"


class RegGroup(Group):
    """How two nodes are registered."""

    Strategy: int = param(0, "0 by images, 1 by clouds (ICP), 2 by images and then by clouds.", ge=0, le=2)
    Force3DoF: bool = param(False, "Planar motion: only x, y and yaw are estimated.", effect=_SESSION)
    RepeatOnce: bool = param(True, "Without a guess, match once more around the transform found.")


class VisGroup(Group):
    """Visual registration and odometry's features."""

    FeatureType: int = param(
        8, "Feature type of odometry and registration, by RTAB-Map's number.", effect=_SESSION, choices=CHOICES
    )
    MaxFeatures: int = param(1000, "Key points per image.", unit="features", ge=1)
    MinInliers: int = param(20, "Fewest inliers of an accepted registration.", unit="inliers", ge=4)
    CorNNType: int = param(
        1,
        "6 lets the LightGlue network match where there is no guess; 0 to 5, RTAB-Map's ways to search nearest"
        " neighbours, all mean the exact search, both ways.",
        ge=0,
        le=6,
        effect=_SESSION,
    )
    CorNNDR: float = param(0.8, "Ratio of nearest to second nearest descriptor of a match.", ge=0, le=1)
    CorGuessWinSize: int = param(40, "Search window around a projected point.", unit="px", ge=1)
    Iterations: int = param(300, "RANSAC iterations.", ge=1)
    EstimationType: int = param(
        1, "0 aligns 3D with 3D, 1 is PnP (2, epipolar geometry, is not supported).", ge=0, le=1
    )
    CorType: int = param(
        0, "0 matches descriptors, 1 follows points by optical flow (keeps each node's images in RAM).", ge=0, le=1
    )
    InlierDistance: float = param(0.1, "With 3D-3D: largest distance of an inlier.", unit="m", ge=0.001)
    RefineIterations: int = param(5, "With 3D-3D: rounds of choosing the inliers anew.", ge=0)
    PnPReprojError: float = param(2.0, "Reprojection error of an inlier.", unit="px", ge=0.1)
    PnPFlags: int = param(0, "Solver of RANSAC's small samples: 0 AP3P, 1 EPnP, 2 P3P.", ge=0, le=2)
    PnPVarianceMedianRatio: int = param(4, "Covariance from the n/ratio-th smallest error.", ge=2)
    PnPSplitLinearCovComponents: bool = param(False, "Linear covariance of each axis by itself.")
    PnPMaxVariance: float = param(0.0, "Largest linear variance of a registration; 0 is off.", unit="m^2", ge=0)
    MeanInliersDistance: float = param(
        0.0, "Largest mean distance of the inliers from the camera; 0 is off.", unit="m", ge=0
    )
    MinInliersDistribution: float = param(
        0.0,
        "Least spread of the inliers over the image: the smaller variance of their place, with sides of 1; 0 is off.",
        ge=0,
        le=0.5,
    )
    CorFlowWinSize: int = param(16, "Optical flow: window.", unit="px", ge=3)
    CorFlowIterations: int = param(30, "Optical flow: most iterations.", ge=1)
    CorFlowEps: float = param(0.01, "Optical flow: step at which to stop.", unit="px", ge=0)
    CorFlowMaxLevel: int = param(3, "Optical flow: levels of the image pyramid above the image.", ge=0, le=10)
    CorFlowErrorThreshold: float = param(20.0, "Optical flow: largest mean difference of gray values.", ge=0)
    MinDepth: float = param(0.0, "Depth from which a key point is used.", unit="m", ge=0)
    MaxDepth: float = param(0.0, "Depth up to which a key point is used; 0 is no limit.", unit="m", ge=0)
    GridRows: int = param(1, "Rows of the grid whose cells get equal shares of the key points.", ge=1, le=64)
    GridCols: int = param(1, "Columns of the grid whose cells get equal shares of the key points.", ge=1, le=64)
    RoiRatios: str = param(_NO_BORDER, "Shares of the image without key points: left, right, top, bottom.")
    SubPixWinSize: int = param(3, "Half the window of the sub-pixel search.", unit="px", ge=1)
    SubPixIterations: int = param(0, "Iterations of the sub-pixel search; 0 is off.", ge=0)
    SubPixEps: float = param(0.02, "Motion at which the sub-pixel search stops.", unit="px", ge=0)

    _checked_roi = field_validator("RoiRatios")(checked_ratios)
    _checked_type = field_validator("FeatureType")(checked_feature_type)


class IcpGroup(Group):
    """Registration of clouds."""

    VoxelSize: float = param(0.05, "Cubes that points are averaged in; 0 keeps all.", unit="m", ge=0)
    DownsamplingStep: int = param(1, "Use every n-th point.", unit="points", ge=1)
    RangeMin: float = param(0.0, "Nearest point used.", unit="m", ge=0)
    RangeMax: float = param(0.0, "Farthest point used; 0 is no limit.", unit="m", ge=0)
    MaxCorrespondenceDistance: float = param(0.1, "Largest distance of a pair of points.", unit="m", ge=0.001)
    OutlierRatio: float = param(0.85, "Share of the pairs, the nearest ones, that counts.", ge=0.01, le=1)
    Iterations: int = param(30, "Most iterations.", ge=1)
    Epsilon: float = param(0.0, "Step (metres and radians) at which to stop; 0 stops when hardly anything moves.", ge=0)
    CorrespondenceRatio: float = param(
        0.1, "Refused when a smaller share of the points of the larger cloud has a partner.", ge=0, le=1
    )
    MaxTranslation: float = param(0.2, "Largest correction of the guess; 0 is no limit.", unit="m", ge=0)
    MaxRotation: float = param(0.78, "Largest correction of the guess; 0 is no limit.", unit="rad", ge=0)
    PointToPlane: bool = param(True, "Distances to the planes around points, not to the points.")
    PointToPlaneK: int = param(5, "Points that a normal is fitted to.", unit="points", ge=3, le=100)
    PointToPlaneMinComplexity: float = param(
        0.02, "Structural complexity (0 a plane, 1 all directions) that planes need to fix all axes.", ge=0, le=1
    )
    PointToPlaneLowComplexityStrategy: int = param(
        1, "Below that: 0 refuses, 1 corrects only axes that are seen, 2 trusts the distances to points.", ge=0, le=2
    )
    Force4DoF: bool = param(False, "Only x, y, z and yaw.")
