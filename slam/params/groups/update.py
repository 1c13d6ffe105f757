"""Parameters of a map update: memories, places, and which frames become nodes."""

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
    CreateIntermediateNodes: bool = param(
        False, "Keep moving frames between two updates as nodes without words, which no loop is looked for with."
    )
    StartNewMapOnGoodSignature: bool = param(
        False, "A session begins with a node that has enough words; those before are not kept."
    )
    StartNewMapOnLoopClosure: bool = param(
        False,
        "Beside a map that is there, a session begins with a node that a loop joins with it.",
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
    RehearsalIdUpdatedToNewOne: bool = param(
        False, "Of two nodes that rehearsal merges the newer stays, and takes the weight; else the older."
    )
    BadSignaturesIgnored: bool = param(False, "Nodes with too few words are not kept.")
    IntermediateNodeDataKept: bool = param(False, "Store the images of intermediate nodes.")
    ReduceGraph: bool = param(
        False, "A node that leaves short-term memory becomes part of the older one that a loop ties it to."
    )
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
    FullPredictionUpdate: bool = param(
        False, "Work out the whole transition at each update, not only what changed; the belief is the same."
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
    OptimizeMaxErrorRepairRadius: float = param(
        0.0,
        "When an old loop link is twice in a row what refuses new loops, it goes instead, and with it the loop links"
        " that end within this radius of its ends; approved and hand-made ones stay; 0 is off.",
        unit="m",
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
