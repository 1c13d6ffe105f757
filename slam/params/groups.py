"""The parameters that some code of slamdeck reads, by RTAB-Map's groups and names."""

from __future__ import annotations

from typing import Literal

from pydantic import field_validator

from slam.params.feature_types import CHOICES, checked_feature_type
from slam.params.registry import Effect, Group, param
from slam.params.roi import checked_ratios

_SESSION = Effect.SESSION
_NO_BORDER = "0.0 0.0 0.0 0.0"
_PREDICTION = (
    "0.1 0.36 0.30 0.16 0.062 0.0151 0.00255 0.000324 2.5e-05 1.3e-06 4.8e-08 1.2e-09 1.9e-11 2.2e-13 1.7e-15 "
    "8.5e-18 2.9e-20 6.9e-23"
)


class RtabmapGroup(Group):
    """The map update as a whole."""

    DetectionRate: float = param(
        2.0, "Map updates per second of the frames' stamps; 0 takes every frame.", unit="Hz", ge=0
    )
    TimeThr: float = param(
        0.0,
        "Time allowed for one update before nodes go to long-term memory; 0 is no limit.",
        unit="ms",
        ge=0,
    )
    MemoryThr: int = param(
        0,
        "Nodes allowed in working memory before nodes go to long-term memory; 0 is no limit.",
        unit="nodes",
        ge=0,
    )
    LoopThr: float = param(0.11, "Loop hypothesis from which a closure is tried.", ge=0, le=1)
    LoopRatio: float = param(0.0, "The hypothesis must reach this fraction of the previous one; 0 is off.", ge=0, le=1)
    MaxRetrieved: int = param(
        2,
        "Neighbours of the best hypothesis brought back from long-term memory per update.",
        unit="nodes",
        ge=0,
    )
    VirtualPlaceLikelihoodRatio: int = param(
        0, "Likelihood of a new place: 0 mean / deviation, 1 deviation / (max - mean).", ge=0, le=1
    )
    StartNewMapOnGoodSignature: bool = param(
        False, "A session begins with a node that has enough words; those before are not kept."
    )
    SaveWMState: bool = param(True, "Store the ids in working memory with each update's statistics.")


class MemGroup(Group):
    """Short-term, working and long-term memory."""

    IncrementalMemory: bool = param(
        True, "Map; false localises in a map that is there and leaves it as it is.", effect=_SESSION
    )
    LocalizationDataSaved: bool = param(
        False, "Store what was seen while localising, as nodes that are no part of the map.", effect=_SESSION
    )
    LocalizationReadOnly: bool = param(False, "Localise without changing one byte of the map file.", effect=_SESSION)
    STMSize: int = param(10, "Nodes in short-term memory.", unit="nodes", ge=1)
    RehearsalSimilarity: float = param(
        0.6, "Share of common words from which a new node merges with the last one; 1 is off.", ge=0, le=1
    )
    RehearsalWeightIgnoredWhileMoving: bool = param(
        False, "A node that looks like the last one adds weight to it only when the robot has not moved."
    )
    BadSignaturesIgnored: bool = param(False, "Nodes with too few words are not kept.")
    RecentWmRatio: float = param(0.2, "Newest share of working memory that never goes to long-term memory.", ge=0, le=1)
    UseOdomFeatures: bool = param(
        True, "Make words from odometry's key points where Vis/FeatureType is Kp/DetectorStrategy."
    )
    InitWMWithAllNodes: bool = param(
        False,
        "A session that goes on with a map begins with all nodes in working memory, not only those left in RAM.",
        effect=_SESSION,
    )
    TransferSortingByWeightId: bool = param(False, "Transfer by weight and id, whatever the time in memory.")
    ImageCompressionFormat: Literal[".jpg", ".png"] = param(".jpg", "Format of stored colour images: .jpg or .png.")
    DepthCompressionFormat: Literal[".rvl", ".png"] = param(".rvl", "Format of stored depth images: .rvl or .png.")
    LaserScanDownsampleStepSize: int = param(
        4, "Each node's cloud for ICP takes every n-th pixel of every n-th row of its depth image.", unit="px", ge=1
    )
    LaserScanVoxelSize: float = param(
        0.05, "Cubes that the points of a node's cloud are averaged in; 0 keeps all.", unit="m", ge=0
    )
    LaserScanNormalK: int = param(
        0, "Points that a normal of a node's cloud is fitted to; 0 leaves normals to ICP.", unit="points", ge=0, le=100
    )


class KpGroup(Group):
    """Visual words."""

    DetectorStrategy: int = param(
        8, "Feature type of the words, by RTAB-Map's number.", effect=_SESSION, choices=CHOICES
    )
    MaxFeatures: int = param(500, "Key points of a node that become words.", unit="words", ge=1)
    MinDepth: float = param(0.0, "Depth from which a key point becomes a word.", unit="m", ge=0)
    MaxDepth: float = param(0.0, "Depth up to which a key point becomes a word; 0 is no limit.", unit="m", ge=0)
    GridRows: int = param(1, "Rows of the grid whose cells get equal shares of the key points.", ge=1, le=64)
    GridCols: int = param(1, "Columns of the grid whose cells get equal shares of the key points.", ge=1, le=64)
    RoiRatios: str = param(_NO_BORDER, "Shares of the image without key points: left, right, top, bottom.")
    SubPixWinSize: int = param(3, "Half the window of the sub-pixel search.", unit="px", ge=1)
    SubPixIterations: int = param(0, "Iterations of the sub-pixel search; 0 is off.", ge=0)
    SubPixEps: float = param(0.02, "Motion at which the sub-pixel search stops.", unit="px", ge=0)
    IncrementalDictionary: bool = param(
        True, "Make new words while mapping; otherwise those of Kp/DictionaryPath.", effect=_SESSION
    )
    DictionaryPath: str = param(
        "", "File with the words of a fixed dictionary: RTAB-Map's text or a map.", effect=_SESSION
    )
    NndrRatio: float = param(
        0.8, "A descriptor is a known word when its nearest is this much nearer than the second.", ge=0, le=1
    )
    NewWordsComparedTogether: bool = param(True, "Compare descriptors with words made from the same image too.")
    BadSignRatio: float = param(
        0.5, "A node with fewer than this share of the usual words is not used for loops.", ge=0, le=1
    )
    TfIdfLikelihoodUsed: bool = param(True, "Likelihood by TF-IDF; otherwise by the share of common words.")

    _checked_roi = field_validator("RoiRatios")(checked_ratios)
    _checked_type = field_validator("DetectorStrategy")(checked_feature_type)


class VhEpGroup(Group):
    """Epipolar check of loop hypotheses."""

    Enabled: bool = param(False, "Hypotheses must fit an epipolar geometry before they are registered.")
    MatchCountMin: int = param(8, "Fewest common words, and inliers among them.", unit="words", ge=8)
    RansacParam1: float = param(3.0, "Distance to the epipolar line of an inlier.", unit="px", ge=0.1)
    RansacParam2: float = param(0.99, "Confidence at which RANSAC stops.", ge=0.5, le=0.9999)


class BayesGroup(Group):
    """The Bayes filter over places."""

    PredictionLC: str = param(
        _PREDICTION, "Transition: virtual place, same place, then graph distance 1, 2, ...", effect=_SESSION
    )
    VirtualPlacePriorThr: float = param(0.9, "Probability that a new place is followed by a new place.", ge=0, le=1)

    @field_validator("PredictionLC")
    @classmethod
    def _is_transition(cls, text: str) -> str:
        right = "two or more numbers from 0 to 1 with spaces between, the first below 1, the others not all 0"
        try:
            virtual, *places = [float(word) for word in text.split()]
        except ValueError as error:
            raise ValueError(right) from error
        if not all(0 <= value <= 1 for value in (virtual, *places)) or virtual == 1 or sum(places) == 0:
            raise ValueError(right)
        return text


class RGBDGroup(Group):
    """The metric graph: which frames become nodes, which loops are kept."""

    LinearUpdate: float = param(0.1, "Motion from which a frame becomes a node.", unit="m", ge=0)
    AngularUpdate: float = param(0.1, "Rotation from which a frame becomes a node.", unit="rad", ge=0)
    LinearSpeedUpdate: float = param(0.0, "Frames of a faster robot become no nodes; 0 is off.", unit="m/s", ge=0)
    AngularSpeedUpdate: float = param(
        0.0, "Frames of a robot that turns faster become no nodes; 0 is off.", unit="rad/s", ge=0
    )
    AggressiveLoopThr: float = param(
        0.05, "LoopThr for places not joined to the current graph yet; 1 is off.", ge=0, le=1
    )
    OptimizeMaxError: float = param(
        3.0,
        "A loop is refused when a link's residual exceeds this many sigmas; 0 is off.",
        unit="sigma",
        ge=0,
    )
    StartAtOrigin: bool = param(
        False, "Localisation starts at the first node instead of where the robot was last.", effect=_SESSION
    )
    MaxOdomCacheSize: int = param(
        10, "Odometry poses that localisation fits to the map together.", unit="poses", ge=1, le=100
    )
    LocalizationPriorError: float = param(
        0.001, "Standard deviation that localisation takes for the poses of the map.", unit="m, rad", ge=1e-4, le=1
    )
    OptimizeFromGraphEnd: bool = param(False, "Hold the newest node fixed instead of the oldest.")
    MaxLoopClosureDistance: float = param(0.0, "Longest accepted loop; 0 is no limit.", unit="m", ge=0)
    LoopCovLimited: bool = param(False, "A loop counts for no surer than the surest odometry link so far.")
    ProximityByTime: bool = param(False, "Look for loops with the nodes in short-term memory.")
    LocalRadius: float = param(10.0, "Radius of the local map.", unit="m", ge=0)
    LocalImmunizationRatio: float = param(0.25, "Share of working memory near the robot that stays there.", ge=0, le=1)
    MaxLocalRetrieved: int = param(
        2, "Nodes near the robot brought back from long-term memory per update.", unit="nodes", ge=0
    )
    ProximityBySpace: bool = param(True, "Look for loops with nodes near by.")
    ProximityMaxGraphDepth: int = param(
        50, "Nodes farther than this in the graph are not tried; 0 is no limit.", unit="links", ge=0
    )
    ProximityMaxPaths: int = param(3, "Paths near by that are tried; 0 is all.", unit="paths", ge=0)
    ProximityPathFilteringRadius: float = param(1.0, "Largest distance of a node near by.", unit="m", ge=0)
    ProximityAngle: float = param(45.0, "Largest difference of viewing direction.", unit="deg", ge=0, le=180)
    ProximityPathMaxNeighbors: int = param(
        0,
        "With ICP: neighbours on each side whose clouds are merged with that of the node near by; 0 is off.",
        unit="nodes",
        ge=0,
    )
    ProximityPathRawPosesUsed: bool = param(
        True, "Merge their clouds by odometry and refined neighbour links rather than by the optimised poses."
    )
    ProximityMergedScanCovFactor: float = param(
        100.0, "Covariance of a loop by merged clouds is that of ICP times this.", ge=1
    )
    NeighborLinkRefining: bool = param(False, "Register each node with the one before, with odometry as the guess.")
    LocalBundleOnLoopClosure: bool = param(
        False, "Adjust a loop together with what the neighbours of the old node saw."
    )
    CreateOccupancyGrid: bool = param(True, "Make a local grid for each node.")


class VisGroup(Group):
    """Visual registration and odometry's features."""

    FeatureType: int = param(
        8, "Feature type of odometry and registration, by RTAB-Map's number.", effect=_SESSION, choices=CHOICES
    )
    MaxFeatures: int = param(1000, "Key points per image.", unit="features", ge=1)
    MinInliers: int = param(20, "Fewest inliers of an accepted registration.", unit="inliers", ge=4)
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


class RegGroup(Group):
    """How two nodes are registered."""

    Strategy: int = param(0, "0 by images, 1 by clouds (ICP), 2 by images and then by clouds.", ge=0, le=2)
    Force3DoF: bool = param(False, "Planar motion: only x, y and yaw are estimated.", effect=_SESSION)
    RepeatOnce: bool = param(True, "Without a guess, match once more around the transform found.")


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


class GFTTGroup(Group):
    """Corner detector."""

    QualityLevel: float = param(0.001, "Weakest corner as a share of the strongest.", ge=1e-6, le=1)
    MinDistance: float = param(7.0, "Least distance between corners.", unit="px", ge=1)
    BlockSize: int = param(3, "Window of the corner measure.", unit="px", ge=3)
    UseHarrisDetector: bool = param(False, "Harris's corner measure instead of Shi and Tomasi's.")
    K: float = param(0.04, "Free factor of Harris's measure.", ge=0, le=0.25)


class FASTGroup(Group):
    """FAST corners."""

    Threshold: int = param(20, "Contrast of a corner with its circle.", unit="grey levels", ge=1, le=255)
    MinThreshold: int = param(
        7, "Contrast taken where ORB-OCTREE finds no stronger corner.", unit="grey levels", ge=1, le=255
    )
    NonmaxSuppression: bool = param(True, "Keep only corners that beat their neighbours.")


class ORBGroup(Group):
    """ORB features, and the ORB descriptor of other corners."""

    ScaleFactor: float = param(2.0, "Ratio of one pyramid level to the next.", ge=1.05, le=4)
    NLevels: int = param(3, "Pyramid levels.", ge=1, le=16)
    EdgeThreshold: int = param(19, "Border without key points.", unit="px", ge=1, le=100)
    FirstLevel: int = param(0, "Pyramid level of the image as it is.", ge=0, le=8)
    ScoreType: int = param(0, "Strength of a key point: 0 Harris's measure, 1 FAST's.", ge=0, le=1)
    PatchSize: int = param(31, "Patch that a descriptor is drawn from.", unit="px", ge=5, le=127)


class BRIEFGroup(Group):
    """The BRIEF descriptor."""

    Bytes: int = param(32, "Length: 16, 32 or 64.", unit="bytes", effect=_SESSION, choices=(16, 32, 64))

    @field_validator("Bytes")
    @classmethod
    def _has_pattern(cls, count: int) -> int:
        if count not in (16, 32, 64):
            raise ValueError("16, 32 or 64 bytes")
        return count


class FREAKGroup(Group):
    """The FREAK descriptor."""

    OrientationNormalized: bool = param(True, "Turn the pattern with the key point.", effect=_SESSION)
    ScaleNormalized: bool = param(True, "Scale the pattern with the key point.", effect=_SESSION)
    PatternScale: float = param(22.0, "Size of the pattern.", unit="px", ge=1, le=100, effect=_SESSION)
    NOctaves: int = param(4, "Octaves that key points may cover.", ge=1, le=8, effect=_SESSION)


class BRISKGroup(Group):
    """BRISK features."""

    Thresh: int = param(30, "Contrast of a corner with its circle.", unit="grey levels", ge=1, le=255)
    Octaves: int = param(3, "Octaves; 0 is a single scale.", ge=0, le=8)
    PatternScale: float = param(1.0, "Scale of the pattern.", ge=0.1, le=10, effect=_SESSION)


class SIFTGroup(Group):
    """SIFT features."""

    NOctaveLayers: int = param(3, "Scales of an octave.", ge=1, le=10)
    ContrastThreshold: float = param(0.04, "Weakest contrast of a key point.", ge=0, le=1)
    EdgeThreshold: float = param(10.0, "Largest ratio of curvatures; above it a key point is an edge.", ge=1)
    Sigma: float = param(1.6, "Blur of the first scale.", unit="px", ge=0.5, le=10)
    PreciseUpscale: bool = param(False, "Upscale the image without shifting it.")
    RootSIFT: bool = param(False, "Roots of the normalised descriptor's numbers.", effect=_SESSION)


class KAZEGroup(Group):
    """KAZE features."""

    Extended: bool = param(False, "128 numbers instead of 64.", effect=_SESSION)
    Upright: bool = param(False, "Don't turn with the key point.", effect=_SESSION)
    Threshold: float = param(0.001, "Weakest response of a key point.", ge=0)
    NOctaves: int = param(4, "Octaves.", ge=1, le=8)
    NOctaveLayers: int = param(4, "Scales of an octave.", ge=1, le=10)
    Diffusivity: int = param(1, "Diffusion: 0 PM g1, 1 PM g2, 2 Weickert, 3 Charbonnier.", ge=0, le=3)


class ALIKEDGroup(Group):
    """ALIKED features, of a network."""

    ModelPath: str = param("", "ONNX file of the network.", effect=_SESSION)


class DISKGroup(Group):
    """DISK features, of a network."""

    ModelPath: str = param("", "ONNX file of the network.", effect=_SESSION)


class SURFGroup(Group):
    """SURF features."""

    HessianThreshold: float = param(500.0, "Weakest response of a key point.", ge=0)
    Octaves: int = param(4, "Octaves.", ge=1, le=8)
    OctaveLayers: int = param(2, "Scales of an octave.", ge=1, le=8)


class OdomGroup(Group):
    """Odometry."""

    Strategy: int = param(0, "Track against 0 a local map, 1 the last key frame.", ge=0, le=1, effect=_SESSION)
    External: int = param(
        0, "Odometry of the source: 0 not used, 1 the guess of visual odometry, 2 alone.", ge=0, le=2, effect=_SESSION
    )
    FilteringStrategy: int = param(0, "Smooth the path: 0 not at all, 1 by a Kalman filter.", ge=0, le=1)
    KalmanProcessNoise: float = param(0.001, "Variance that the velocity gains per frame.", ge=1e-9)
    KalmanMeasurementNoise: float = param(0.01, "Variance of a measured velocity.", ge=1e-9)
    GuessMotion: bool = param(True, "Predict the next pose with constant velocity.")
    ResetCountdown: int = param(
        0, "Lost frames after which odometry starts anew, as a new session; 0 waits.", unit="frames", ge=0
    )
    ReadoutTime: float = param(
        -1.0,
        "Time between the first and the last row of a colour image; 0 is a global shutter, below 0 it is estimated.",
        unit="ms",
        ge=-1,
        le=50,
    )
    KeyFrameThr: float = param(0.3, "New key frame when inliers fall below this share of features.", ge=0, le=1)
    VisKeyFrameThr: int = param(150, "New key frame when inliers fall below this number.", unit="inliers", ge=0)


class OdomF2MGroup(Group):
    """Frame-to-map odometry."""

    MaxSize: int = param(2000, "Points in the local map.", unit="points", ge=100)
    BundleAdjustment: int = param(0, "Adjust key frames and points together: 0 off, 1 on.", ge=0, le=1)
    BundleAdjustmentMaxFrames: int = param(10, "Key frames that are adjusted together.", unit="frames", ge=2, le=50)


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
