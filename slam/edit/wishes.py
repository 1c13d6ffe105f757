"""What people may want of links, and what came of it; light, so that whoever only asks loads nothing heavy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, NamedTuple

from slam.geometry import Array, Pose
from slam.params import Value
from slam.types import Link, LinkType, Manner, Refusal, Registration

if TYPE_CHECKING:
    from slam.effect import Effect

#: By images, by clouds, or by images and from there by clouds.
Method = Literal["visual", "icp", "both"]
#: Where the search begins: at the optimised poses, or without any idea (clouds: at the same pose).
Guess = Literal["graph", "none"]


@dataclass(frozen=True, slots=True)
class Matching:
    """How two nodes are registered."""

    method: Method = "visual"
    guess: Guess = "graph"


class PickedPair(NamedTuple):
    """The same point in two nodes: of each x, y in pixels of its image, or x, y, z in metres of its base frame."""

    at_from: tuple[float, ...]
    at_to: tuple[float, ...]


LinkAction = Literal["add", "points", "refine", "edit", "reset"]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LinkEdit:
    """What somebody wants of a link.

    Attributes:
        action: ``add`` by registration, add by picked ``points``, ``refine`` by registration around what the link says,
            ``edit`` (or add) with numbers that were typed, ``reset`` to what it was before anybody edited it.
        from_id: one of both nodes.
        to_id: the other one.
        how: of the registration.
        pairs: picked points of both images or clouds.
        T_from_to: (4, 4) that was typed.
        sigmas: (6,) x y z in metres, roll pitch yaw in radians; 0 means that nothing is known of the axis.
        author: who wants it.
        force: do it although the graph or the points object.
    """

    action: LinkAction
    from_id: int
    to_id: int
    how: Matching = field(default_factory=Matching)
    pairs: Sequence[PickedPair] = ()
    T_from_to: Pose | None = None
    sigmas: Array | None = None
    author: str = ""
    force: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What came of it, or would.

    Attributes:
        link: as it is, or would be; None where nothing was found.
        registration: evidence of the images or clouds, where they were asked.
        residuals_m: of picked points (N,), where there were some.
        refusal: the test that speaks against it.
        effect: on the map; None where there is no link.
    """

    link: Link | None = None
    registration: Registration | None = None
    residuals_m: Array | None = None
    refusal: Refusal | None = None
    effect: Effect | None = None


@dataclass(frozen=True, slots=True)
class Detection:
    """What is looked for.

    Attributes:
        radius_m: largest distance of two nodes.
        min_radius_m: smallest distance of two nodes.
        angle_deg: largest angle between their forward axes.
        iterations: rounds; after each the poses are those of the graph with what was found.
        min_graph_distance: fewest links between two nodes of one session.
        intra: pairs of one session.
        inter: pairs of two sessions.
        session: only pairs with a node of this session; -1 for all.
        method: of the registration.
        guess: where it begins.
    """

    radius_m: float = 1.0
    min_radius_m: float = 0.0
    angle_deg: float = 30.0
    iterations: int = 5
    min_graph_distance: int = 10
    intra: bool = True
    inter: bool = True
    session: int = -1
    method: Method = "visual"
    guess: Guess = "none"


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkChoice:
    """Which links.

    Attributes:
        types: kinds of links; none for all.
        first: smallest id of a node, both ends; 0 for no limit.
        last: largest id of a node, both ends; 0 for no limit.
        intra: links within one session.
        inter: links between two sessions.
        session: only links of a node of this session; -1 for all.
    """

    types: tuple[LinkType, ...] = ()
    first: int = 0
    last: int = 0
    intra: bool = True
    inter: bool = True
    session: int = -1


@dataclass(frozen=True, slots=True, kw_only=True)
class Refinement(LinkChoice):
    """Links that are registered anew.

    Attributes:
        method: of the registration, which begins at what the link says.
        covariance_only: transforms stay.
    """

    method: Method = "visual"
    covariance_only: bool = False


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Regrid:
    """Local grids that are made anew.

    Attributes:
        changes: parameters of the group ``Grid/`` that differ from those of the map.
        first: smallest id of a node; 0 for no limit.
        last: largest id of a node; 0 for no limit.
        session: only nodes of this session; -1 for all.
    """

    changes: Mapping[str, Value] = field(default_factory=dict)
    first: int = 0
    last: int = 0
    session: int = -1


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class CovarianceEdit(LinkChoice):
    """Links and sightings of landmarks that get other covariances; their transforms stay.

    Attributes:
        sigmas: (6,) x y z in metres, roll pitch yaw in radians, in the frame of the link's first node; 0 means that
            nothing is known of the axis.
        author: who wants it.
    """

    sigmas: Array
    author: str = ""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PriorEdit:
    """What somebody wants of a node's pose prior.

    Attributes:
        node_id: the node.
        T_map_base: (4, 4) where it is; None takes the prior away.
        sigmas: (6,) as in ``LinkEdit``, in the node's own frame; three zeros for the angles make it a position alone.
        count: let priors count from then on, where ``Optimizer/PriorsIgnored`` keeps them from it.
        author: who wants it.
    """

    node_id: int
    T_map_base: Pose | None = None
    sigmas: Array | None = None
    count: bool = False
    author: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Optimisation:
    """Poses to keep.

    Attributes:
        manner: how the graph is optimised.
        step: the iteration whose poses are kept, 0 for the start; None for the last.
        author: who wants it.
    """

    manner: Manner
    step: int | None = None
    author: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Turn:
    """Where the whole map is to be.

    Attributes:
        yaw_rad: turned by this about the z axis of the map.
        to: instead of that laid over the true path, or over GPS readings (x east, y north, from the first of them).
        author: who wants it.
    """

    yaw_rad: float = 0.0
    to: Literal["truth", "gps"] | None = None
    author: str = ""
