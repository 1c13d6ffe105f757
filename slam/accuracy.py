"""How far the trajectory of a map is from ground truth, whether its sessions are joined or not."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from slam.evaluate import absolute_error, align
from slam.geometry import Pose
from slam.graph.components import components
from slam.trajectory import assemble
from slam.types import TrackedFrame

#: Fewer positions can't be aligned.
_LEAST = 3


def frames_ate_m(
    frames: Sequence[TrackedFrame], poses: Mapping[int, Pose], pairs: Iterable[tuple[int, int]]
) -> float | None:
    """Absolute trajectory error of all tracked frames, metres; None without ground truth.

    Args:
        frames: of all sessions.
        poses: id -> ``T_map_base``.
        pairs: ids that links join; what no link joins is aligned on its own, for it says nothing about the other.
    """
    path = assemble(frames, poses)
    return pooled_ate_m(path.T_world_base, path.T_map_base, path.node_ids, pairs)


def pooled_ate_m(
    T_world_base: NDArray[np.float64],
    T_map_base: NDArray[np.float64],
    node_ids: NDArray[np.int64],
    pairs: Iterable[tuple[int, int]],
) -> float | None:
    """The same of poses (N, 4, 4) that hang on nodes (N,); those with NaN for truth are left out.

    Root of the mean squared distance over all pieces of the graph, each aligned by SE(3) on its own; pieces of fewer
    than three positions are left out.
    """
    known = np.isfinite(T_world_base[:, 0, 3])
    joined = list(pairs)
    piece_of = components({*node_ids.tolist(), *(i for pair in joined for i in pair)}, joined)
    pieces = np.array([piece_of[i] for i in node_ids.tolist()], np.int64)
    squares, count = 0.0, 0
    for piece in np.unique(pieces[known]):
        rows = known & (pieces == piece)
        if rows.sum() >= _LEAST:
            error = absolute_error(T_world_base[rows], T_map_base[rows])
            squares, count = squares + error.pairs * error.rmse_m**2, count + error.pairs
    return float(np.sqrt(squares / count)) if count else None


def map_error_m(
    frames: Sequence[TrackedFrame], poses: Mapping[int, Pose], truth: Mapping[int, NDArray[np.float64]]
) -> float | None:
    """RMSE in metres of localised frames, in the frame that the map itself defines; None without ground truth.

    Args:
        frames: of the session that localised.
        poses: id -> ``T_map_base`` of the map's nodes.
        truth: id -> ``T_world_base`` of them, NaN where unknown.
    """
    known = [i for i in sorted(poses) if i in truth and np.isfinite(truth[i][0, 3])]
    path = assemble(frames, poses)
    rows = np.isfinite(path.T_world_base[:, 0, 3])
    if len(known) < _LEAST or not rows.any():
        return None
    T_world_map = align(np.array([truth[i][:3, 3] for i in known]), np.array([poses[i][:3, 3] for i in known]))
    found = path.T_map_base[rows, :3, 3] @ T_world_map[:3, :3].T + T_world_map[:3, 3]
    return float(np.sqrt(np.mean(np.sum((found - path.T_world_base[rows, :3, 3]) ** 2, axis=1))))
