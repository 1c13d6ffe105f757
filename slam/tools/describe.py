"""What a map file holds beyond its counts: weights, time, length, and what is missing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from slam.database import Faults, MapReader, NodeTable
from slam.database.flaws import Flaws
from slam.geometry import Pose
from slam.types import WEIGHT_INTERMEDIATE, WEIGHT_INVALID

#: Ids that are named before the rest is only counted.
_NAMED = 5
_NOWHERE = np.full((4, 4), np.nan)


@dataclass(frozen=True, slots=True)
class Description:
    """A map file at a second look.

    Attributes:
        weights: number of nodes by class: seen once (weight 0), seen again (above), intermediate (-1), dropped (-9).
        labels: node by label.
        span_s: seconds from the first to the last node, sessions added up.
        odometry_m: length of odometry's path, sessions added up.
        map_m: the same through optimised poses, None where none are stored.
        with_images: number of nodes that have an image.
        with_truth: number of nodes whose true pose is known.
        missing: what is not as it should be, a sentence for each.
    """

    weights: dict[str, int]
    labels: dict[str, int]
    span_s: float
    odometry_m: float
    map_m: float | None
    with_images: int
    with_truth: int
    missing: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PathSize:
    """Seconds and metres of a map's path, sessions added up; ``map_m`` is None where no pose is known."""

    span_s: float
    odometry_m: float
    map_m: float | None


def path_size(table: NodeTable, poses: Mapping[int, Pose]) -> PathSize:
    """How long the path of these nodes is, by odometry and by poses (id -> ``T_map_base``)."""
    at_map = np.array([poses.get(i, _NOWHERE) for i in table.ids.tolist()]).reshape(-1, 4, 4)
    span_s = sum(float(np.ptp(table.stamps[rows])) for rows in _sessions(table))
    return PathSize(span_s, _length(table, table.T_odom), _length(table, at_map) if poses else None)


def describe(reader: MapReader, faults: Faults | None = None) -> Description:
    """Look at nodes, links and key points of a file.

    Args:
        reader: of the file.
        faults: gets rows that make no sense; without it they are an error.

    Raises:
        DatabaseError: it can't be read.
    """
    table, poses = reader.nodes(faults), reader.poses()
    kept, path = table.weights > WEIGHT_INVALID, path_size(table, poses)
    return Description(
        weights={
            "seen once": int((table.weights == 0).sum()),
            "seen again": int((table.weights > 0).sum()),
            "intermediate": int((table.weights == WEIGHT_INTERMEDIATE).sum()),
            "dropped": int((~kept).sum()),
        },
        labels={label: i for i, label in zip(table.ids.tolist(), table.labels, strict=True) if label},
        span_s=path.span_s,
        odometry_m=path.odometry_m,
        map_m=path.map_m,
        with_images=len(reader.nodes_with("image")),
        with_truth=int(np.isfinite(table.T_world[kept]).all(axis=(1, 2)).sum()),
        missing=tuple(_missing(reader, table, len(poses), faults)),
    )


def _missing(reader: MapReader, table: NodeTable, poses: int, faults: Faults | None) -> list[str]:
    info, flaws = reader.info(sizes=False, faults=faults), reader.flaws()
    found = [] if info.clean else ["the last session was not closed in order"]
    found += told(flaws)
    kept = table.ids[table.weights > WEIGHT_INVALID]
    if len(kept) and not poses:
        found.append("no optimised poses are stored")
    if len(kept) and not flaws.no_parameters and not len(reader.memory_ids()[0]):
        found.append("no node is younger than the last session's end: RTAB-Map would load none")
    bare = np.setdiff1d(kept, reader.nodes_with("calibration"))
    if len(bare):
        found.append(f"{len(bare)} nodes without a calibration: {_some(bare.tolist())}")
    return found


def told(flaws: Flaws) -> list[str]:
    """Flaws in words, those that there are."""
    told = (
        ("links without their reverse", flaws.one_way),
        ("links with a node that is not there", flaws.dangling),
        ("words that key points have and the dictionary has not", flaws.unknown_words),
        ("nodes that are not there and have key points", flaws.orphan_features),
        ("nodes that are not there and have data", flaws.orphan_data),
        ("nodes without an odometry pose", flaws.without_pose),
    )
    lines = [f"{len(items)} {what}: {_some(items)}" for what, items in told if items]
    return [*lines, "no parameters are stored: RTAB-Map would load no node"] if flaws.no_parameters else lines


def _some(items: Sequence[object]) -> str:
    names = ["-".join(map(str, item)) if isinstance(item, tuple) else str(item) for item in items[:_NAMED]]
    return ", ".join([*names, "..."] if len(items) > _NAMED else names)


def _sessions(table: NodeTable) -> list[np.ndarray]:
    kept = table.weights > WEIGHT_INVALID
    return [np.flatnonzero(kept & (table.map_ids == map_id)) for map_id in np.unique(table.map_ids[kept])]


def _length(table: NodeTable, poses: np.ndarray) -> float:
    total = 0.0
    for rows in _sessions(table):
        points = poses[rows][:, :3, 3]
        points = points[np.isfinite(points).all(axis=1)]
        total += float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    return total
