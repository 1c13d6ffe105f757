"""Shapes of links and loop candidates."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from server.schemas.base import Axes, Pair, PoseList, Schema, Size
from server.schemas.nodes import UserData
from slam.database import LoopState


class LoopReason(Schema):
    """Why a loop was refused: the test, its value and the threshold that it missed."""

    test: str
    value: float | None
    threshold: float | None
    text: str


class LoopDoubt(Schema):
    """What speaks against a loop, each in sigmas; None where it can't be told."""

    score: float
    """The largest of the three over what is usual in this map: above 1 the loop is suspect."""
    residual: float | None
    """How far the optimised poses are from it."""
    odometry: float | None
    """How far odometry alone is from it."""
    neighbors: float | None
    """How far the loops near by are from it (median)."""
    compared: int
    """Loops near by."""
    agreeing: int
    """Those of them that it agrees with."""


class LoopRival(Schema):
    """A place elsewhere in the map that looks like the one which the loop leads to."""

    node: int
    distance_m: float
    share: float
    """Of the place's likelihood or posterior: near 1 it was nearly as likely."""


class LoopRow(Schema):
    """A loop in the review queue."""

    key: str
    """Both ids as they are stored, ``147-61``."""
    from_: int = Field(alias="from")
    to: int
    type: str
    state: LoopState
    posterior: float | None
    inliers: int | None
    matches: int | None
    residual_sigma: float | None
    """None while the link isn't in the graph."""
    doubt: LoopDoubt | None
    """None where there is no transform to judge."""
    translation_m: float | None
    graph_distance: int
    """Nodes from one end to the other along the path."""
    sessions: Pair
    """Of both ends."""
    look_alike: LoopRival | None
    update: int
    """The node whose update looked at it."""
    reason: LoopReason | None


class Loops(Schema):
    """Every loop that was looked at; of a pair, the last word."""

    loops: list[LoopRow]
    counts: dict[str, int]
    """By state."""


class LoopWeights(Schema):
    """How much graduated non-convexity (GNC) lets each loop count."""

    state: Literal["none", "running", "done", "failed"]
    message: str
    """Why it failed."""
    seconds: float
    """That it took, or has taken so far."""
    stale: bool
    """Whether the map has changed since."""
    weights: dict[str, float]
    """From 0 to 1, by both ids, smaller first: ``61-147``."""


class LinkDetail(Schema):
    """A link, or a candidate that didn't become one, with its evidence."""

    from_: int = Field(alias="from")
    to: int
    type: str
    state: LoopState | None
    """None for odometry."""
    transform: PoseList | None
    translation_m: float | None
    rotation_deg: float | None
    sigma_m: Axes | None
    sigma_deg: Axes | None
    residual_sigma: float | None
    chi2: float | None
    chi2_share: float | None
    """Of the whole graph's chi2."""
    doubt: LoopDoubt | None
    posterior: float | None
    inliers: int | None
    matches: int | None
    reason: LoopReason | None
    look_alike: LoopRival | None
    covariance: list[list[float]] | None
    """6x6, ordered x y z roll pitch yaw; None where nothing was measured."""
    update: int | None
    """The node whose update looked at it; None for links that were never a candidate."""
    explanation: str
    optimized: PoseList | None
    """The same transform by the optimised poses; None where one of the nodes has none."""
    off_m: float | None
    """How far the measured transform is from that."""
    off_deg: float | None
    off: PoseList | None
    """The optimised transform as seen from the measured one."""
    merged_scans: list[int]
    """Nodes whose scans were put together to make it."""
    user_data: UserData | None
    problem: str
    """What is stored with it and can't be read, with the reason; empty where all can."""
    scans: list[bool]
    """Whether the first node has points of a scanner, and whether the second has."""
    walk: LinkWalk


class KnownLink(Schema):
    """What is known of a pair of nodes."""

    link: LinkDetail | None
    """None where they are not linked, and no loop between them was looked at."""
    note: str
    """Why there is none."""


class LinkWalk(Schema):
    """Where a link stands among all of its class, in the order of nodes: odometry's links, or loops in the graph."""

    loops: bool
    """Whether it is walked among loops."""
    index: int | None
    """From 1; None where it is not in the graph."""
    total: int
    previous: Pair | None
    next: Pair | None
    other: Pair | None
    """The nearest link of the other class."""


class LinkMatches(Schema):
    """Matched key points of both images of a link; entry i of each list is the same match."""

    from_: Size = Field(alias="from")
    to: Size
    x1: list[float]
    y1: list[float]
    x2: list[float]
    y2: list[float]
    inlier: list[bool]
    recomputed: bool
    """Matched now from the stored key points, not when the link was made."""
