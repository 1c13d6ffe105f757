"""Records of a small made-up map, the same for the same seed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.database import MapWriter, NodeRecord, WordRows
from slam.geometry import between, from_quat_xyzw, make
from slam.params import Params
from slam.types import (
    Candidate,
    Features,
    Link,
    LinkType,
    LocalGrid,
    Node,
    OccupancyGrid,
    Odometry,
    Posterior,
    Refusal,
    Tier,
    TrackedFrame,
    Update,
)

CAMERA = Camera(64, 48, 52.5, 52.0, 31.5, 23.5)


def pose(node_id: int) -> NDArray[np.float64]:
    """A pose on a circle, float32-exact where a rotation by quarters allows."""
    return from_quat_xyzw(np.array([0.0, 0.1, 0.01 * node_id, 1.0]), np.array([0.1 * node_id, -0.5, 0.25]))


def features(rng: np.random.Generator, count: int, width: int = 32) -> Features:
    points = rng.normal(size=(count, 3)).astype(np.float32)
    points[::7] = np.nan
    return Features(
        pixels=rng.uniform(0, 40, (count, 2)).astype(np.float32),
        sizes=rng.integers(3, 31, count).astype(np.float32),
        angles=rng.uniform(0, 360, count).astype(np.float32),
        responses=rng.uniform(0, 1, count).astype(np.float32),
        octaves=rng.integers(0, 8, count).astype(np.int32),
        descriptors=rng.integers(0, 256, (count, width)).astype(np.uint8),
        points_base=points,
    )


def posterior(rng: np.random.Generator, count: int) -> Posterior:
    weights = rng.uniform(size=count + 1)
    weights /= weights.sum()
    return Posterior(
        node_ids=np.arange(1, count + 1, dtype=np.int32),
        likelihood=rng.uniform(size=count),
        probability=weights[:count],
        virtual_place=float(weights[count]),
        virtual_likelihood=1.25,
    )


def update(rng: np.random.Generator, node: Node) -> Update:
    odometry = Odometry(node.T_odom_base, np.eye(6), node.features, 120, 80, True, None, 12.5)
    refused = Refusal("Vis/MinInliers", 12.0, 20.0, "12 inliers, 20 needed")
    older = max(1, node.id - 1)
    candidates = (
        Candidate(node.id, older, LinkType.GLOBAL_CLOSURE, 0.25, 90, 60, pose(1), 50.0 * np.eye(6), None),
        Candidate(node.id, older, LinkType.LOCAL_SPACE_CLOSURE, np.nan, -1, -1, None, None, refused),
    )
    return Update(
        frame_index=10 * node.id,
        stamp=node.stamp,
        odometry=odometry,
        T_map_base=pose(node.id),
        node=node,
        weight=node.weight,
        posterior=posterior(rng, node.id) if node.id > 1 else None,
        candidates=candidates if node.id > 1 else (),
        tiers={node.id: Tier.STM, older: Tier.WM} if node.id > 1 else {node.id: Tier.STM},
        optimized=node.id % 2 == 0,
        statistics={},
        time_ms=33.25,
    )


def frames(node_id: int) -> tuple[TrackedFrame, ...]:
    first = TrackedFrame(2 * node_id, 100.0 + node_id, max(0, node_id - 1), pose(1), pose(node_id), 75, 11.5)
    lost = TrackedFrame(
        2 * node_id + 1, 100.5 + node_id, max(0, node_id - 1), None, None, 3, 9.0, "3 inliers, 20 needed"
    )
    return first, lost


def record(node_id: int, *, map_id: int = 0, count: int = 40, new_words: int = 10, **changes: Any) -> NodeRecord:
    """Node ``node_id`` linked to the one before it; of its key points the first ``new_words`` are new words."""
    rng = np.random.default_rng(node_id)
    items = features(rng, count)
    word_ids = -np.arange(1, count + 1, dtype=np.int32)
    words = np.arange(1, new_words + 1, dtype=np.int32) + 1000 * node_id
    word_ids[:new_words] = words
    node = Node(
        node_id, map_id, node_id % 3, 100.0 + node_id, pose(node_id), items, word_ids, CAMERA, pose(node_id + 1)
    )
    link = Link(node_id, node_id - 1, LinkType.NEIGHBOR, between(pose(node_id), pose(node_id - 1)), 100.0 * np.eye(6))
    cells = rng.integers(0, 50, (30, 2)).astype(np.float32) * np.float32(0.05)
    values: dict[str, Any] = {
        "node": node,
        "update": update(rng, node),
        "image_bgr": rng.integers(0, 256, (48, 64, 3)).astype(np.uint8),
        "depth_m": (rng.integers(0, 5000, (48, 64)) / 1000).astype(np.float32),
        "links": (link,) if node_id > 1 else (),
        "words": WordRows(words, items.descriptors[:new_words]),
        "grid": LocalGrid(cells[:10], cells[10:15], cells[15:], 0.05, (0.1, 0.2, 0.3)),
        "statistics": {"Timing/Total/ms": 33.25, "Loop/Highest_hypothesis_value/": 0.125 * node_id},
        "wm_ids": tuple(range(1, node_id + 1)),
        "frames": frames(node_id),
        "poses": {i: pose(i) for i in range(1, node_id + 1)},
        "grid_map": OccupancyGrid(rng.integers(-1, 101, (7, 5)).astype(np.int8), -1.5, -2.0, 0.05),
    }
    return NodeRecord(**(values | changes))


def records(count: int) -> Iterator[NodeRecord]:
    return (record(node_id) for node_id in range(1, count + 1))


def write_map(path: Path, count: int = 5, params: Params | None = None) -> Path:
    """A closed map of ``count`` nodes, the last three of which are in working memory."""
    params = params or Params()
    with MapWriter.create(path, params, seed=7, source="made up") as writer:
        for item in records(count):
            writer.add_node(item)
        ram = range(max(1, count - 2), count + 1)
        words = [1000 * i + j for i in ram for j in range(1, 11)]
        writer.close_session(ram_ids=ram, ram_word_ids=words, params=params)
    return path


IDENTITY = make(np.eye(3), np.zeros(3))
