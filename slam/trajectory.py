"""The path of all frames: each hangs on a node, so that it follows when the map is corrected."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Pose
from slam.types import TrackedFrame


@dataclass(frozen=True, slots=True, eq=False)
class Path:
    """Poses T_map_base (N, 4, 4) with stamps (N,) in seconds and ground truth (N, 4, 4), NaN where unknown.

    ``node_ids`` (N,) are the nodes that they hang on.
    """

    stamps: NDArray[np.float64]
    T_map_base: NDArray[np.float64]
    T_world_base: NDArray[np.float64]
    node_ids: NDArray[np.int64]


def assemble(frames: Sequence[TrackedFrame], poses: Mapping[int, Pose]) -> Path:
    """The path of the tracked frames through the corrected map; frames that hang on no known node are left out."""
    unknown = np.full((4, 4), np.nan)
    stamps: list[float] = []
    path: list[Pose] = []
    truth: list[Pose] = []
    node_ids: list[int] = []
    for frame in frames:
        if frame.T_node_base is not None and frame.node_id in poses:
            stamps.append(frame.stamp)
            node_ids.append(frame.node_id)
            path.append(poses[frame.node_id] @ frame.T_node_base)
            truth.append(unknown if frame.T_world_base is None else frame.T_world_base)
    return Path(
        np.array(stamps),
        np.array(path).reshape(-1, 4, 4),
        np.array(truth).reshape(-1, 4, 4),
        np.array(node_ids, np.int64),
    )
