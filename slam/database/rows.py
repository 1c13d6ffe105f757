"""What the reader hands out: frozen rows and columns of a map file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Pose


@dataclass(frozen=True, slots=True)
class MapInfo:
    """What ``slamdeck info`` says of a map file.

    Attributes:
        path: the file.
        version: of RTAB-Map's schema.
        sessions: number of sessions.
        nodes: nodes of the map; merged and dropped ones (weight -9) are not counted.
        dropped: those merged and dropped nodes that are kept in the file.
        links: number of links by type name, each pair once.
        words: words of the dictionary.
        features: key points stored.
        size_bytes: of the file and its log.
        bytes_by_kind: bytes of the content by kind (``image``, ``depth``, ...); empty when it was not asked for.
        parameters: stored parameters that differ from the defaults.
        seeds: one for each session that slamdeck wrote.
        sources: likewise.
        clean: whether the last session was closed in order.
        has_poses: whether optimised poses are stored.
        first_stamp: of the first node, seconds; None for an empty map.
        last_stamp: of the last node.
    """

    path: Path
    version: str
    sessions: int
    nodes: int
    dropped: int
    links: Mapping[str, int]
    words: int
    features: int
    size_bytes: int
    bytes_by_kind: Mapping[str, int]
    parameters: Mapping[str, str]
    seeds: tuple[int, ...]
    sources: tuple[str, ...]
    clean: bool
    has_poses: bool
    first_stamp: float | None
    last_stamp: float | None


@dataclass(frozen=True, slots=True, eq=False)
class NodeTable:
    """The nodes of a map as columns, ascending by id.

    Attributes:
        ids: (N,) int32.
        map_ids: (N,) int32 session numbers.
        weights: (N,) int32; -9 for merged and dropped nodes.
        stamps: (N,) seconds.
        T_odom: (N, 4, 4) odometry poses T_odom_base, NaN where unknown.
        T_world: (N, 4, 4) ground truth T_world_base, NaN where unknown.
        labels: text or None.
    """

    ids: NDArray[np.int32]
    map_ids: NDArray[np.int32]
    weights: NDArray[np.int32]
    stamps: NDArray[np.float64]
    T_odom: NDArray[np.float64]
    T_world: NDArray[np.float64]
    labels: tuple[str | None, ...]

    def __len__(self) -> int:
        return len(self.ids)


@dataclass(frozen=True, slots=True, eq=False)
class NodeRow:
    """One node in full, but for its images and key points.

    Attributes:
        id: node id.
        map_id: session number.
        weight: -9 for a merged or dropped node.
        stamp: seconds.
        label: text or None.
        T_odom_base: odometry pose, None where unknown.
        T_world_base: ground truth, None where unknown.
        features: number of key points.
        words: number of those that are words of the dictionary.
        image_bytes: size of the stored image, 0 when there is none.
        depth_bytes: size of the stored depth image, 0 when there is none.
        calibration_bytes: size of the stored calibration, 0 when there is none.
        has_grid: whether a local grid is stored.
    """

    id: int
    map_id: int
    weight: int
    stamp: float
    label: str | None
    T_odom_base: Pose | None
    T_world_base: Pose | None
    features: int
    words: int
    image_bytes: int
    depth_bytes: int
    calibration_bytes: int
    has_grid: bool


@dataclass(frozen=True, slots=True)
class SessionRow:
    """One session; what RTAB-Map does not store is None or empty for its files.

    Attributes:
        map_id: session number.
        nodes: number of its nodes, without the dropped ones.
        started: Unix seconds.
        closed: Unix seconds; None while it runs, or when it was killed and not healed yet.
        clean: whether it was closed in order.
        seed: of the random numbers.
        source: where the frames came from.
        parameters: all of them, as text by name.
    """

    map_id: int
    nodes: int
    started: float | None
    closed: float | None
    clean: bool
    seed: int | None
    source: str
    parameters: Mapping[str, str]


@dataclass(frozen=True, slots=True, eq=False)
class StatisticsTable:
    """Statistics of updates as columns.

    Attributes:
        ids: (N,) int32 node ids, ascending.
        stamps: (N,) seconds.
        values: name -> (N,) float64, NaN where an update does not have it.
    """

    ids: NDArray[np.int32]
    stamps: NDArray[np.float64]
    values: Mapping[str, NDArray[np.float64]]
