"""Rehearsal: a node that looks like the last one makes that one weigh more; and when a node counts as moved."""

from __future__ import annotations

from dataclasses import dataclass

from slam.geometry import Pose, between, so3_log
from slam.loop.likelihood import WordBag, similarity
from slam.memory.memory import Memory
from slam.params import Params
from slam.types import WEIGHT_INTERMEDIATE, Node


@dataclass(frozen=True, slots=True)
class Rehearsal:
    """Outcome: the older node, how alike both are, and the weight that the older one gets."""

    node_id: int
    similarity: float
    weight: int


def rehearse(node: Node, memory: Memory, params: Params) -> Rehearsal | None:
    """Compares a new node with the last one in STM; None when they differ (``Mem/RehearsalSimilarity``)."""
    if not memory.stm or params.Mem.RehearsalSimilarity >= 1.0:
        return None
    last_id = memory.stm[-1]
    alike = similarity(WordBag.of(node), memory.bags[last_id])
    if alike < params.Mem.RehearsalSimilarity:
        return None
    weight = memory.weights[last_id] + node.weight + 1
    return Rehearsal(last_id, alike, weight)


def stands_still(last: Node | None, node: Node, rehearsal: Rehearsal | None, memory: Memory, params: Params) -> bool:
    """Whether the robot has not moved since the last place, so that the frame is no new one.

    After an intermediate node it may have come back to that place; then it stands if that looks the same.
    """
    if last is None or (last.weight == WEIGHT_INTERMEDIATE and rehearsal is None):
        return False
    if last.weight == WEIGHT_INTERMEDIATE and rehearsal is not None:
        last = memory.nodes[rehearsal.node_id]
    return not moved(last, node, params)


def rehearsed(rehearsal: Rehearsal, memory: Memory, params: Params) -> int:
    """Gives the older node its weight, or takes it away (``Mem/RehearsalIdUpdatedToNewOne``); the new one's weight."""
    if not params.Mem.RehearsalIdUpdatedToNewOne:
        memory.set_weight(rehearsal.node_id, rehearsal.weight)
        return 0
    # A node that was replaced is gone, or has become an intermediate one.
    if memory.weights.get(rehearsal.node_id, -1) > 0:
        memory.set_weight(rehearsal.node_id, 0)
    return rehearsal.weight


def moved(last: Node, node: Node, params: Params) -> bool:
    """Whether two nodes are of two sessions, or ``apart``."""
    return last.map_id != node.map_id or apart(last.T_odom_base, node.T_odom_base, params)


def apart(T_odom_last: Pose, T_odom_now: Pose, params: Params) -> bool:
    """Whether two poses of one odometry are farther apart than ``RGBD/LinearUpdate`` or ``AngularUpdate``."""
    T_last_now = between(T_odom_last, T_odom_now)
    far = bool((abs(T_last_now[:3, 3]) > params.RGBD.LinearUpdate).any())
    turned = bool((abs(so3_log(T_last_now[:3, :3])) > params.RGBD.AngularUpdate).any())
    return far or turned
