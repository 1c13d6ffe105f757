"""A made-up map with drift, loops that were accepted and one that was refused, for tests that need no engine."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from slam.database import MapWriter
from slam.geometry import Pose, between, se3_exp
from slam.params import Params
from slam.types import Candidate, Link, LinkType, Refusal, Tier
from tests.unit.database.map_records import record

NODES = 12
#: Loops by (newer, older): the first two are in the graph, the third was refused, with a transform.
ACCEPTED = ((11, 1), (12, 2))
REFUSED = (10, 3)
INFORMATION = np.diag([400.0] * 3 + [4000.0] * 3)


def true_pose(node_id: int) -> Pose:
    """On a circle of 3 m, one lap in ten nodes."""
    angle = 2 * np.pi * (node_id - 1) / 10
    turn = se3_exp(np.array([0.0, 0.0, 0.0, 0.0, 0.0, angle]))
    turn[:3, 3] = (3 * np.sin(angle), 3 * (1 - np.cos(angle)), 0.0)
    return turn


def odometry_pose(node_id: int) -> Pose:
    """The same with a drift that grows with every node."""
    return np.asarray(true_pose(node_id) @ se3_exp(0.004 * node_id * np.array([1.0, -1.0, 0.3, 0.0, 0.0, 0.4])))


def write_loop_map(path: Path, *, close: bool = True) -> MapWriter | None:
    """Write the map; with ``close=False`` the writer stays open, as in a run, and is returned."""
    params = Params().changed({"Rtabmap/LoopThr": 0.2})
    writer = MapWriter.create(path, params, seed=3, source="made up")
    for node_id in range(1, NODES + 1):
        add_node(writer, node_id)
    if not close:
        return writer
    writer.close_session(ram_ids=range(NODES - 2, NODES + 1), ram_word_ids=(), params=params)
    writer.close()
    return None


def add_node(writer: MapWriter, node_id: int) -> None:
    """Add one node as an update of the engine does."""
    item = record(node_id)
    node = replace(item.node, T_odom_base=odometry_pose(node_id), T_world_base=true_pose(node_id), weight=node_id % 4)
    candidates = _candidates(node_id)
    tiers = {node_id: Tier.STM, **({node_id - 2: Tier.WM} if node_id > 2 else {})}
    if node_id > 6:
        tiers[node_id - 6] = Tier.LTM
    writer.add_node(
        replace(
            item,
            node=node,
            links=(*_neighbor(node_id), *_loops(node_id)),
            update=replace(item.update, node=node, candidates=candidates, tiers=tiers),
            poses={i: odometry_pose(i) for i in range(1, node_id + 1)},
            frames=tuple(
                replace(frame, node_id=node_id, T_node_base=np.eye(4), T_world_base=true_pose(node_id), lost="")
                for frame in item.frames[:1]
            ),
        )
    )


def _neighbor(node_id: int) -> tuple[Link, ...]:
    if node_id == 1:
        return ()
    step = between(odometry_pose(node_id), odometry_pose(node_id - 1))
    return (Link(node_id, node_id - 1, LinkType.NEIGHBOR, step, INFORMATION),)


def _loops(node_id: int) -> tuple[Link, ...]:
    return tuple(
        Link(newer, older, LinkType.GLOBAL_CLOSURE, between(true_pose(newer), true_pose(older)), INFORMATION)
        for newer, older in ACCEPTED
        if newer == node_id
    )


def _candidates(node_id: int) -> tuple[Candidate, ...]:
    found = [
        Candidate(
            newer,
            older,
            LinkType.GLOBAL_CLOSURE,
            0.42,
            90,
            61,
            between(true_pose(newer), true_pose(older)),
            INFORMATION,
            None,
        )
        for newer, older in ACCEPTED
        if newer == node_id
    ]
    if node_id == REFUSED[0]:
        transform = between(true_pose(REFUSED[0]), true_pose(REFUSED[1]))
        why = Refusal("Vis/MinInliers", 12.0, 20.0, "12 inliers, Vis/MinInliers needs 20")
        found.append(Candidate(*REFUSED, LinkType.GLOBAL_CLOSURE, 0.3, 40, 12, transform, INFORMATION, why))
    return tuple(found)
