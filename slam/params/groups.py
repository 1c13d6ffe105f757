"""The parameters that some code of slamdeck reads, by RTAB-Map's groups and names."""

from __future__ import annotations

from typing import Literal

from pydantic import field_validator

from slam.params.registry import Effect, Group, param

_SESSION = Effect.SESSION
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
    InitWMWithAllNodes: bool = param(
        False,
        "A session that goes on with a map begins with all nodes in working memory, not only those left in RAM.",
        effect=_SESSION,
    )
    TransferSortingByWeightId: bool = param(False, "Transfer by weight and id, whatever the time in memory.")
    ImageCompressionFormat: Literal[".jpg", ".png"] = param(".jpg", "Format of stored colour images: .jpg or .png.")
    DepthCompressionFormat: Literal[".rvl", ".png"] = param(".rvl", "Format of stored depth images: .rvl or .png.")


class KpGroup(Group):
    """Visual words."""

    MaxFeatures: int = param(500, "Key points of a node that become words.", unit="words", ge=1)
    NndrRatio: float = param(
        0.8, "A descriptor is a known word when its nearest is this much nearer than the second.", ge=0, le=1
    )
    NewWordsComparedTogether: bool = param(True, "Compare descriptors with words made from the same image too.")
    BadSignRatio: float = param(
        0.5, "A node with fewer than this share of the usual words is not used for loops.", ge=0, le=1
    )
    TfIdfLikelihoodUsed: bool = param(True, "Likelihood by TF-IDF; otherwise by the share of common words.")


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
    CreateOccupancyGrid: bool = param(True, "Make a local grid for each node.")


class VisGroup(Group):
    """Visual registration and odometry's features."""

    MaxFeatures: int = param(1000, "Key points per image.", unit="features", ge=1)
    MinInliers: int = param(20, "Fewest inliers of an accepted registration.", unit="inliers", ge=4)
    CorNNDR: float = param(0.8, "Ratio of nearest to second nearest descriptor of a match.", ge=0, le=1)
    CorGuessWinSize: int = param(40, "Search window around a projected point.", unit="px", ge=1)
    Iterations: int = param(300, "RANSAC iterations.", ge=1)
    PnPReprojError: float = param(2.0, "Reprojection error of an inlier.", unit="px", ge=0.1)
    PnPVarianceMedianRatio: int = param(4, "Covariance from the n/ratio-th smallest error.", ge=2)
    MinDepth: float = param(0.0, "Depth from which a key point is used.", unit="m", ge=0)
    MaxDepth: float = param(0.0, "Depth up to which a key point is used; 0 is no limit.", unit="m", ge=0)


class GFTTGroup(Group):
    """Corner detector."""

    QualityLevel: float = param(0.001, "Weakest corner as a share of the strongest.", ge=1e-6, le=1)
    MinDistance: float = param(7.0, "Least distance between corners.", unit="px", ge=1)
    BlockSize: int = param(3, "Window of the corner measure.", unit="px", ge=3)


class OdomGroup(Group):
    """Odometry."""

    GuessMotion: bool = param(True, "Predict the next pose with constant velocity.")
    ResetCountdown: int = param(
        0, "Lost frames after which odometry starts anew, as a new session; 0 waits.", unit="frames", ge=0
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

    Iterations: int = param(20, "Most iterations.", ge=1)
    Epsilon: float = param(1e-5, "Relative decrease of the error at which to stop.", ge=0)


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
