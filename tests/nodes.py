"""Made-up key points, words and nodes for tests that need no images."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Pose, make
from slam.graph.graph import PoseGraph
from slam.loop.likelihood import WordBag
from slam.memory.memory import Memory
from slam.params import Params
from slam.types import Features, Link, LinkType, Node

CAMERA = Camera(320, 240, 262.5, 262.5, 159.5, 119.5)
INFORMATION = np.diag([1e4] * 3 + [1e5] * 3)


def flipped(descriptor: NDArray[np.uint8], bits: Sequence[int]) -> NDArray[np.uint8]:
    """A copy of a descriptor (32,) with these of its 256 bits inverted: ``len(bits)`` away from it."""
    changed = descriptor.copy()
    for bit in bits:
        changed[bit // 8] ^= np.uint8(1 << bit % 8)
    return changed


def random_descriptors(count: int, seed: int) -> NDArray[np.uint8]:
    """(count, 32) descriptors, about 128 bits from each other."""
    return np.random.default_rng(seed).integers(0, 256, (count, 32)).astype(np.uint8)


def features(descriptors: NDArray[np.uint8], *, seed: int = 0) -> Features:
    """Key points with these descriptors, every fifth without depth."""
    rng, count = np.random.default_rng([seed, count_key(descriptors)]), len(descriptors)
    points = rng.normal(size=(count, 3)).astype(np.float32)
    points[::5] = np.nan
    return Features(
        pixels=rng.uniform(20, 200, (count, 2)).astype(np.float32),
        sizes=np.full(count, 31, np.float32),
        angles=np.full(count, -1, np.float32),
        responses=np.sort(rng.uniform(0.1, 1, count))[::-1].astype(np.float32),
        octaves=np.zeros(count, np.int32),
        descriptors=descriptors,
        points_base=points,
    )


def count_key(descriptors: NDArray[np.uint8]) -> int:
    """A number that depends on the descriptors, to seed with."""
    return int(descriptors.astype(np.int64).sum())


def at(x: float, y: float = 0.0, yaw_deg: float = 0.0) -> Pose:
    """A pose on the floor: metres, and degrees to the left of x."""
    c, s = np.cos(np.radians(yaw_deg)), np.sin(np.radians(yaw_deg))
    return make(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.array([x, y, 0.0]))


def node(
    node_id: int, items: Features, word_ids: NDArray[np.int32], *, pose: Pose | None = None, map_id: int = 0
) -> Node:
    """A node of weight 0 that was seen ``node_id`` seconds after the start."""
    T_odom_base = at(float(node_id)) if pose is None else pose
    return Node(node_id, map_id, 0, float(node_id), T_odom_base, items, word_ids, CAMERA)


def add_place(
    memory: Memory,
    graph: PoseGraph,
    descriptors: NDArray[np.uint8],
    params: Params,
    *,
    pose: Pose | None = None,
    map_id: int = 0,
) -> Node:
    """Puts a new node into memory and graph, linked with the one before it in its session, as ``Slam`` does."""
    node_id = len(graph) + 1
    items = features(descriptors)
    word_ids, _ = memory.quantize(items, params)
    new = node(node_id, items, word_ids, pose=pose, map_id=map_id)
    graph.add_node(node_id, map_id, new.T_odom_base, new.T_odom_base)
    memory.add(new, params)
    if node_id > 1 and graph.map_ids[node_id - 1] == map_id:
        join(graph, node_id, node_id - 1, LinkType.NEIGHBOR)
    return new


def join(graph: PoseGraph, from_id: int, to_id: int, type: LinkType = LinkType.GLOBAL_CLOSURE) -> Link:
    """Links two nodes of a graph, in agreement with their poses."""
    T_from_to = np.linalg.inv(graph.poses[from_id]) @ graph.poses[to_id]
    link = Link(from_id, to_id, type, np.asarray(T_from_to), INFORMATION)
    graph.add_link(link)
    return link


def chain(count: int, *, spacing: float = 1.0, first: int = 1) -> PoseGraph:
    """A straight walk: ids from ``first``, ``spacing`` metres apart, joined by neighbour links."""
    graph = PoseGraph()
    for k in range(count):
        graph.add_node(first + k, 0, at(k * spacing), at(k * spacing))
        if k:
            join(graph, first + k, first + k - 1, LinkType.NEIGHBOR)
    return graph


def bag(words: Sequence[int], unquantized: int = 0) -> WordBag:
    """The words of a node that saw these, repeated ones more often, and so many key points that became no word."""
    ids, counts = np.unique(np.array(words, np.int32), return_counts=True)
    return WordBag(ids, counts, max(1, len(words) + unquantized))
