"""Two nodes beside each other: the words that both saw, where they are to each other, and what links them."""

from __future__ import annotations

from collections import Counter

import numpy as np

from server.browse.columns import pose_list
from server.browse.map_view import MapView
from server.browse.nodes import node_link, require_known
from server.browse.snapshot import Snapshot
from server.schemas import NodePair, PoseDifference, SharedWords
from slam.geometry import Pose, between, rotation_angle, translation_norm


def node_pair(view: MapView, node_a: int, node_b: int) -> NodePair:
    """What two nodes have in common; raises NotFoundError when the file lacks one of them."""
    snapshot = view.snapshot()
    rows = [require_known(snapshot, node_id) for node_id in (node_a, node_b)]
    table = snapshot.all_nodes
    linked = [link for link in snapshot.links_at.get(node_a, []) if set(link.pair) == {node_a, node_b}]
    return NodePair(
        apart_s=float(table.stamps[rows[1]] - table.stamps[rows[0]]),
        map=_difference(snapshot.poses.get(node_a), snapshot.poses.get(node_b)),
        odometry=_odometry(snapshot, rows),
        truth=_difference(*(table.T_world[row] for row in rows)),
        links=[node_link(link) for link in linked if node_a != node_b],
        words=shared_words(view, node_a, node_b),
    )


def shared_words(view: MapView, node_a: int, node_b: int) -> SharedWords:
    """Key points of both nodes that are the same word.

    A word that is there several times in one image could be any of them: such key points are marked as shared, and
    only words that each image has once are pairs, as in RTAB-Map.
    """
    ids = [view.reader.features(node_id)[1].tolist() for node_id in (node_a, node_b)]
    times = [Counter(word for word in words if word > 0) for words in ids]
    common = sorted(times[0].keys() & times[1].keys())
    single = [word for word in common if times[0][word] == times[1][word] == 1]
    places = [{word: at for at, word in enumerate(words)} for words in ids]
    return SharedWords(
        words=len(common),
        of=[len(times[0]), len(times[1])],
        shared_a=[at for at, word in enumerate(ids[0]) if word > 0 and word in times[1]],
        shared_b=[at for at, word in enumerate(ids[1]) if word > 0 and word in times[0]],
        word=single,
        a=[places[0][word] for word in single],
        b=[places[1][word] for word in single],
    )


def _odometry(snapshot: Snapshot, rows: list[int]) -> PoseDifference | None:
    """By odometry, which begins anew with each session."""
    table = snapshot.all_nodes
    if table.map_ids[rows[0]] != table.map_ids[rows[1]]:
        return None
    return _difference(*(table.T_odom[row] for row in rows))


def _difference(T_w_a: Pose | None, T_w_b: Pose | None) -> PoseDifference | None:
    """The pose of b as seen from a; None where either is not known."""
    if T_w_a is None or T_w_b is None or not (np.isfinite(T_w_a).all() and np.isfinite(T_w_b).all()):
        return None
    return pose_difference(between(T_w_a, T_w_b))


def pose_difference(T_a_b: Pose) -> PoseDifference:
    """A transform with its length and its angle."""
    return PoseDifference(
        transform=pose_list(T_a_b) or [],
        translation_m=translation_norm(T_a_b),
        rotation_deg=float(np.degrees(rotation_angle(T_a_b))),
    )
