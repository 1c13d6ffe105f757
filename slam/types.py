"""The frozen values that the stages of the pipeline hand to each other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum, StrEnum

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Pose

#: Descriptors (N, B): uint8 holds B bytes of bits, compared by Hamming distance; float32 holds B numbers, by L2.
Descriptors = NDArray[np.uint8] | NDArray[np.float32]

#: Variance that means "do not use", as in RTAB-Map.
UNKNOWN_VARIANCE = 9999.0

#: Weight of a node that was merged or discarded, and of one that is only part of the graph.
WEIGHT_INVALID = -9
WEIGHT_INTERMEDIATE = -1


class LinkType(IntEnum):
    """RTAB-Map's link types, by their number in the database."""

    NEIGHBOR = 0
    GLOBAL_CLOSURE = 1
    LOCAL_SPACE_CLOSURE = 2
    LOCAL_TIME_CLOSURE = 3
    USER_CLOSURE = 4
    VIRTUAL_CLOSURE = 5
    NEIGHBOR_MERGED = 6
    POSE_PRIOR = 7
    LANDMARK = 8
    GRAVITY = 9

    @property
    def label(self) -> str:
        """Name as RTAB-Map prints it, for example ``GlobalClosure``."""
        return "".join(part.capitalize() for part in self.name.split("_"))

    @property
    def is_loop(self) -> bool:
        """Whether it joins two places beyond odometry."""
        return LinkType.GLOBAL_CLOSURE <= self <= LinkType.USER_CLOSURE


class Tier(StrEnum):
    """The memory a node lives in."""

    STM = "stm"
    WM = "wm"
    LTM = "ltm"


@dataclass(frozen=True, slots=True, eq=False)
class ExternalOdometry:
    """Where somebody else's odometry has the base.

    Attributes:
        T_odom_base: (4, 4) in a frame of its own.
        variances: (2,) linear (m^2) and angular (rad^2), of all the motion since its start.
    """

    T_odom_base: Pose
    variances: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One synchronised colour and depth image, rectified.

    Attributes:
        index: running number in its source, from 0.
        stamp: acquisition time of the colour image in seconds.
        image_bgr: (H, W, 3) uint8.
        depth_m: (H, W) float32 depth along the optical axis in metres, 0 where unknown.
        camera: the camera of both images.
        T_world_base: ground truth, where known.
        T_gravity_base: attitude of the base with respect to gravity (rotation only), where an accelerometer tells.
        depth_delay_s: acquisition time of the depth image minus ``stamp``.
        external: odometry from outside, where there is any.
    """

    index: int
    stamp: float
    image_bgr: NDArray[np.uint8]
    depth_m: NDArray[np.float32]
    camera: Camera
    T_world_base: Pose | None = None
    T_gravity_base: Pose | None = None
    depth_delay_s: float = 0.0
    external: ExternalOdometry | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Features:
    """Key points of one image with descriptors and depth; row i of each array is the same key point.

    Attributes:
        pixels: (N, 2) float32, x then y.
        sizes: (N,) float32 diameter in pixels.
        angles: (N,) float32 degrees, -1 where the detector gives none.
        responses: (N,) float32 detector score.
        octaves: (N,) int32.
        descriptors: (N, B) uint8 for binary descriptors of B bytes, or float32.
        points_base: (N, 3) float32 in the base frame, metres, NaN where there is no depth.
    """

    pixels: NDArray[np.float32]
    sizes: NDArray[np.float32]
    angles: NDArray[np.float32]
    responses: NDArray[np.float32]
    octaves: NDArray[np.int32]
    descriptors: Descriptors
    points_base: NDArray[np.float32]

    def __len__(self) -> int:
        return len(self.pixels)

    def take(self, rows: NDArray[np.integer] | NDArray[np.bool_]) -> Features:
        """The features of these rows, in this order."""
        return Features(
            self.pixels[rows],
            self.sizes[rows],
            self.angles[rows],
            self.responses[rows],
            self.octaves[rows],
            self.descriptors[rows],
            self.points_base[rows],
        )


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why something was not done: the test that failed, its value, and the threshold it missed.

    ``test`` is a parameter name where one decides (``Vis/MinInliers``), else a short noun (``depth``).
    """

    test: str
    value: float
    threshold: float
    text: str


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """Points of one place for ICP, from a depth image or a laser.

    Attributes:
        points_base: (N, 3) float32 in the base frame, metres, all finite.
        normals_base: (N, 3) float32 unit normals; None when they were not computed.
        most: points that one look can have, where that is fewer than N: what a merged scan is measured by; 0 for N.
    """

    points_base: NDArray[np.float32]
    normals_base: NDArray[np.float32] | None = None
    most: int = 0

    def __len__(self) -> int:
        return len(self.points_base)


@dataclass(frozen=True, slots=True, eq=False)
class Images:
    """What optical flow needs of a frame: (H, W) uint8 gray, and (H, W) float32 depth in metres, 0 where unknown."""

    gray: NDArray[np.uint8]
    depth_m: NDArray[np.float32]


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


@dataclass(frozen=True, slots=True, eq=False)
class Odometry:
    """Result of tracking one frame.

    Attributes:
        T_odom_base: (4, 4) pose, None when tracking was lost.
        covariance: (6, 6) of the motion since the last tracked frame; 9999 on the diagonal after a (re)start.
        features: what was seen in this frame.
        matches: number of features matched with the local map.
        inliers: number of those that agree with the pose.
        keyframe: whether the local map took in this frame.
        lost: reason, value and threshold when tracking was lost.
        time_ms: time this took.
    """

    T_odom_base: Pose | None
    covariance: NDArray[np.float64]
    features: Features
    matches: int
    inliers: int
    keyframe: bool
    lost: Refusal | None
    time_ms: float


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A constraint: pose(to) = pose(from) @ T_from_to.

    Attributes:
        from_id: node id.
        to_id: node id; equal to from_id for priors and gravity; negative for landmarks.
        type: what it is.
        T_from_to: (4, 4), None for the marker of a merged node.
        information: (6, 6) inverse covariance, x y z roll pitch yaw.
    """

    from_id: int
    to_id: int
    type: LinkType
    T_from_to: Pose | None
    information: NDArray[np.float64]

    @property
    def pair(self) -> tuple[int, int]:
        """Both ids, smaller first."""
        return min(self.from_id, self.to_id), max(self.from_id, self.to_id)


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A loop closure that was looked at, with its evidence; accepted when ``refusal`` is None.

    Attributes:
        from_id: the newer node.
        to_id: the older node.
        type: GLOBAL_CLOSURE or LOCAL_SPACE_CLOSURE.
        posterior: 1 - P(virtual place) for a global closure, NaN for a proximity one.
        matches: features matched; -1 when it was refused before matching; points compared when only scans were.
        inliers: matches that agree with the transform; -1 likewise; points that have a partner likewise.
        T_from_to: (4, 4) transform where the registration found one.
        information: (6, 6) where the registration found one.
        refusal: which test refused it.
        by_scans: whether only scans were compared.
    """

    from_id: int
    to_id: int
    type: LinkType
    posterior: float
    matches: int
    inliers: int
    T_from_to: Pose | None
    information: NDArray[np.float64] | None
    refusal: Refusal | None
    by_scans: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Node:
    """A place of the map: what memory keeps of it in RAM.

    Attributes:
        id: positive, ascending in time.
        map_id: session number.
        weight: 0 and up; -1 intermediate, -9 invalid.
        stamp: seconds.
        T_odom_base: (4, 4) odometry pose.
        features: up to Vis/MaxFeatures key points, best first.
        word_ids: (N,) int32; > 0 is a word of the dictionary, < 0 a key point that was not quantised.
        camera: the camera that saw it.
        T_world_base: ground truth where known.
        scan: its cloud, where ``Reg/Strategy`` asks for ICP.
        images: its images, where ``Vis/CorType`` asks for optical flow.
    """

    id: int
    map_id: int
    weight: int
    stamp: float
    T_odom_base: Pose
    features: Features
    word_ids: NDArray[np.int32]
    camera: Camera
    T_world_base: Pose | None = None
    scan: Scan | None = None
    images: Images | None = None


@dataclass(frozen=True, slots=True, eq=False)
class LocalGrid:
    """What one node says about the floor plan: cell centres (N, 2) float32 in its base frame, levelled, metres."""

    ground: NDArray[np.float32]
    obstacles: NDArray[np.float32]
    empty: NDArray[np.float32]
    cell_size: float
    view_point: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class OccupancyGrid:
    """A 2D map: ``cells`` (rows = y, columns = x) int8, -1 unknown, 0 free, 100 occupied.

    Cell (row, col) has its lower left corner at x_min + col * cell_size, y_min + row * cell_size, in the map frame.
    """

    cells: NDArray[np.int8]
    x_min: float
    y_min: float
    cell_size: float


@dataclass(frozen=True, slots=True, eq=False)
class Posterior:
    """The Bayes filter's belief after one update.

    Attributes:
        node_ids: (N,) int32 places in WM, ascending.
        likelihood: (N,) adjusted likelihood.
        probability: (N,) posterior; with ``virtual_place`` it sums to one.
        virtual_place: probability of being nowhere known.
        virtual_likelihood: adjusted likelihood of that.
    """

    node_ids: NDArray[np.int32]
    likelihood: NDArray[np.float64]
    probability: NDArray[np.float64]
    virtual_place: float
    virtual_likelihood: float

    @property
    def best_id(self) -> int:
        """The most probable place, 0 when there is none."""
        return int(self.node_ids[int(np.argmax(self.probability))]) if len(self.node_ids) else 0

    @property
    def value(self) -> float:
        """What LoopThr is compared with: 1 - P(virtual place)."""
        return 1.0 - self.virtual_place if len(self.node_ids) else 0.0


@dataclass(frozen=True, slots=True, eq=False)
class TrackedFrame:
    """One frame of the trajectory: its pose hangs on the last node before it.

    Attributes:
        index: number in the source.
        stamp: seconds.
        node_id: the node it hangs on, 0 before the first.
        T_node_base: (4, 4) pose in that node's base frame; None when tracking was lost.
        T_world_base: ground truth where known.
        inliers: of the odometry.
        odometry_ms: time the odometry took.
        lost: text of the reason, empty when tracked.
        covariance: (6, 6) of its pose in axes of the map when localising in a finished one; 9999 while not recognised.
    """

    index: int
    stamp: float
    node_id: int
    T_node_base: Pose | None
    T_world_base: Pose | None
    inliers: int
    odometry_ms: float
    lost: str = ""
    covariance: NDArray[np.float64] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Update:
    """All that ``Slam.process`` did with one frame.

    Attributes:
        frame_index: of the source.
        stamp: seconds.
        odometry: tracking result.
        T_map_base: (4, 4) pose in the map, None when lost; a guess while ``covariance`` is 9999.
        covariance: (6, 6) of that pose in axes of the map, m^2 and rad^2; only when localising in a finished map.
        node: the node that was added, None for a frame in between.
        weight: weight the node ended up with (-9 when it was merged or dropped).
        posterior: belief over WM, None where it was not computed.
        candidates: loop closures looked at, accepted and refused.
        tiers: id -> tier of the nodes whose tier changed in this update.
        optimized: whether poses of older nodes moved.
        statistics: RTAB-Map names -> values.
        time_ms: time the update took (without odometry).
    """

    frame_index: int
    stamp: float
    odometry: Odometry
    T_map_base: Pose | None
    node: Node | None = None
    weight: int = 0
    posterior: Posterior | None = None
    candidates: tuple[Candidate, ...] = ()
    tiers: Mapping[int, Tier] = field(default_factory=dict)
    optimized: bool = False
    statistics: Mapping[str, float] = field(default_factory=dict)
    time_ms: float = 0.0
    covariance: NDArray[np.float64] | None = None
