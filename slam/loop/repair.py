"""Old loop links that keep new ones out are taken back (``RGBD/OptimizeMaxErrorRepairRadius``)."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from slam.graph.graph import Pair, PoseGraph, name
from slam.params import Params
from slam.types import Candidate, Link, LinkType, Refusal

_TEST = "RGBD/OptimizeMaxErrorRepairRadius"


def wrong_since(blamed: Link | None, graph: PoseGraph, kept: Collection[Pair], params: Params) -> list[Link]:
    """The loop links that go when ``blamed`` is found to be wrong: itself and those with an end near one of its ends.

    Args:
        blamed: the link that the poses contradict most.
        graph: with its poses.
        kept: pairs that somebody has approved; those stay, as do links made by hand.
        params: ``RGBD/OptimizeMaxErrorRepairRadius`` is read.

    Returns:
        The links, ``blamed`` first; none where ``blamed`` is no loop of the graph, or is kept itself.
    """
    radius = params.RGBD.OptimizeMaxErrorRepairRadius
    if blamed is None or radius <= 0 or graph.links.get(blamed.pair) is not blamed or not _may_go(blamed, kept):
        return []
    ends = np.array([graph.poses[i][:3, 3] for i in blamed.pair])
    found = [blamed]
    for pair in sorted(graph.links):
        link = graph.links[pair]
        if link is not blamed and _may_go(link, kept):
            positions = np.array([graph.poses[i][:3, 3] for i in pair])
            if np.linalg.norm(positions[:, None] - ends[None], axis=2).min() <= radius:
                found.append(link)
    return found


def taken_back(link: Link, blamed: Link, params: Params) -> Candidate:
    """What is said of a link that went: it can be approved by hand again."""
    radius = params.RGBD.OptimizeMaxErrorRepairRadius
    what = "it" if link is blamed else f"{name(blamed)} near it"
    text = f"taken back: twice in a row {what} contradicted new loops ({_TEST} {radius:g} m)"
    return Candidate(
        from_id=link.from_id,
        to_id=link.to_id,
        type=link.type,
        posterior=float("nan"),
        matches=-1,
        inliers=-1,
        T_from_to=link.T_from_to,
        information=link.information,
        refusal=Refusal(_TEST, 2.0, 2.0, text),
    )


def _may_go(link: Link, kept: Collection[Pair]) -> bool:
    return link.type.is_loop and link.type is not LinkType.USER_CLOSURE and link.pair not in kept
