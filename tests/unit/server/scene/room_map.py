"""A map with images for tests: two laps around the middle of a room, with a ceiling, loops and a refused one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.database import MapWriter, NodeRecord
from slam.features.words import nothing_seen
from slam.geometry import Pose, between, make
from slam.params import Params
from slam.types import (
    Candidate,
    Link,
    LinkType,
    Node,
    OccupancyGrid,
    Odometry,
    Refusal,
    Tier,
    Update,
)

NODES = 24
LAP = 12
CAMERA = Camera(80, 60, 66.0, 66.0, 39.5, 29.5)
LOOPS = {13: (1, LinkType.GLOBAL_CLOSURE), 16: (4, LinkType.LOCAL_SPACE_CLOSURE), 20: (8, LinkType.USER_CLOSURE)}
REFUSED = (18, 2)
#: Half of the room's sides, and the heights of its floor and ceiling over the camera, metres.
HALF, FLOOR, CEILING = 3.0, -1.2, 1.6
GRID = OccupancyGrid(np.array([[0, 0, -1], [100, 0, -1]], dtype=np.int8), -1.0, -0.5, 0.5)


def true_pose(node_id: int) -> Pose:
    """On a circle of 1 m, looking outwards."""
    angle = 2.0 * np.pi * (node_id - 1) / LAP
    c, s = np.cos(angle), np.sin(angle)
    return make(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.array([c, s, 0.0]))


def odometry_pose(node_id: int) -> Pose:
    """Drifts away along x, from where its own frame has the first node."""
    drift = np.eye(4)
    drift[:3, 3] = (0.02 * node_id, 0.0, 0.0)
    return np.asarray(between(true_pose(1), true_pose(node_id)) @ drift)


def seen(node_id: int) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Image and depth of the empty room from a node."""
    u, v = np.meshgrid(np.arange(CAMERA.width), np.arange(CAMERA.height))
    rays = CAMERA.unproject(np.column_stack([u.ravel(), v.ravel()]), np.ones(u.size))
    T_map_cam = true_pose(node_id) @ CAMERA.T_base_cam
    directions, origin = rays @ T_map_cam[:3, :3].T, T_map_cam[:3, 3]
    low, high = np.array([-HALF, -HALF, FLOOR]), np.array([HALF, HALF, CEILING])
    with np.errstate(divide="ignore"):
        reach = np.where(directions > 0, (high - origin) / directions, (low - origin) / directions)
    depth = np.where(np.isfinite(reach), reach, np.inf).min(axis=1)
    hit = origin + depth[:, None] * directions
    colour = ((hit - low) / (high - low) * 255).clip(0, 255).astype(np.uint8)
    shape = (CAMERA.height, CAMERA.width)
    return colour.reshape(*shape, 3), depth.reshape(shape).astype(np.float32)


def write_room_map(path: Path, nodes: int = NODES, *, images: bool = True, closed: bool = True) -> Path:
    """The map file; a map that is not ``closed`` looks like one that is still being made."""
    with MapWriter.create(path, Params(), seed=0, source="made up") as writer:
        for node_id in range(1, nodes + 1):
            writer.add_node(_record(node_id, images=images))
        writer.save_poses({i: true_pose(i) for i in range(1, nodes + 1)}, None)
        if closed:
            writer.close_session(ram_ids=range(1, nodes + 1), ram_word_ids=[], params=Params())
    return path


def _record(node_id: int, *, images: bool) -> NodeRecord:
    features = nothing_seen()
    node = Node(
        node_id,
        0,
        node_id % 4,
        float(node_id),
        odometry_pose(node_id),
        features,
        np.zeros(0, np.int32),
        CAMERA,
        true_pose(node_id),
    )
    odometry = Odometry(node.T_odom_base, np.eye(6), features, 0, 0, True, None, 1.0)
    tiers = {node_id: Tier.STM} | ({node_id - 5: Tier.WM} if node_id > 5 else {})
    if node_id > 15:
        tiers[node_id - 15] = Tier.LTM
    update = Update(
        node_id, node.stamp, odometry, true_pose(node_id), node, candidates=_candidates(node_id), tiers=tiers
    )
    image, depth = seen(node_id) if images else (None, None)
    return NodeRecord(node=node, update=update, image_bgr=image, depth_m=depth, links=_links(node_id), grid_map=GRID)


def _links(node_id: int) -> tuple[Link, ...]:
    ends = [(node_id - 1, LinkType.NEIGHBOR)] if node_id > 1 else []
    ends += [LOOPS[node_id]] if node_id in LOOPS else []
    return tuple(
        Link(node_id, other, kind, between(true_pose(node_id), true_pose(other)), 100.0 * np.eye(6))
        for other, kind in ends
    )


def _candidates(node_id: int) -> tuple[Candidate, ...]:
    if node_id != REFUSED[0]:
        return ()
    refusal = Refusal("Vis/MinInliers", 12.0, 20.0, "12 inliers, 20 needed")
    return (Candidate(*REFUSED, LinkType.GLOBAL_CLOSURE, 0.3, 40, 12, None, None, refusal),)
