"""Where the nodes of a map truly were, of maps that know it, and how far other poses are from that."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from slam.accuracy import frames_ate_m, pooled_ate_m
from slam.database import NodeTable
from slam.evaluate import align
from slam.geometry import Pose
from slam.types import TrackedFrame


class Truth:
    """Ground truth of the nodes of a map."""

    def __init__(
        self, nodes: NodeTable, poses: Mapping[int, Pose], frames: Callable[[], Sequence[TrackedFrame]]
    ) -> None:
        """Of nodes that the map has at ``poses`` (id -> T_map_base); ``frames`` reads all tracked frames."""
        self._nodes = nodes
        self._poses = poses
        self._read_frames = frames

    @cached_property
    def is_known(self) -> bool:
        """Whether any node knows where it truly was."""
        return bool(np.isfinite(self._nodes.T_world[:, 0, 3]).any())

    def ate_at(self, poses: Mapping[int, Pose], pairs: Iterable[tuple[int, int]]) -> float | None:
        """Absolute trajectory error in metres with nodes at these poses and links between these pairs.

        Of all tracked frames, or of nodes where frames aren't stored; None without truth.
        """
        if not self.is_known:
            return None
        if self._frames:
            return frames_ate_m(self._frames, poses, pairs)
        return pooled_ate_m(*self._path(poses), pairs)

    @cached_property
    def T_map_world(self) -> Pose:
        """Lays the true path over the map's, by the nodes that have both; NaN where none has."""
        T_world, T_map, _ = self._path(self._poses)
        known = np.isfinite(T_world[:, 0, 3])
        return align(T_map[known, :3, 3], T_world[known, :3, 3]) if known.any() else np.full((4, 4), np.nan)

    @cached_property
    def _frames(self) -> Sequence[TrackedFrame]:
        return self._read_frames()

    def _path(self, poses: Mapping[int, Pose]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
        """True poses (N, 4, 4), those given, and ids (N,), of the nodes that have one of these."""
        rows = [row for row, node_id in enumerate(self._nodes.ids.tolist()) if node_id in poses]
        ids = self._nodes.ids[rows].astype(np.int64)
        T_map = np.array([poses[node_id] for node_id in ids.tolist()]).reshape(-1, 4, 4)
        return self._nodes.T_world[rows], T_map, ids
