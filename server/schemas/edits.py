"""Shapes of edits of links and nodes, and of jobs."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from server.schemas.base import PoseList, Schema
from server.schemas.decisions import DecisionResult
from server.schemas.links import LoopReason

Id = Annotated[int, Field(ge=1, le=2**31 - 1)]
Author = Annotated[str, Field(max_length=80)]
Six = Annotated[list[float], Field(min_length=6, max_length=6)]
Four = Annotated[list[float], Field(min_length=4, max_length=4)]
MethodName = Literal["visual", "icp", "both"]
GuessName = Literal["graph", "none"]
JobKind = Literal["detect", "refine", "regrid"]
LinkTypeName = Literal[
    "Neighbor",
    "GlobalClosure",
    "LocalSpaceClosure",
    "LocalTimeClosure",
    "UserClosure",
    "NeighborMerged",
    "Landmark",
]


class LinkEdit(Schema):
    """What to do with the link of two nodes."""

    action: Literal["add", "points", "refine", "edit", "reset"]
    """``add`` by registration, ``points`` by picked points, ``refine`` what is there, ``edit`` by numbers."""
    from_: Id = Field(alias="from")
    to: Id
    method: MethodName = "visual"
    guess: GuessName = "graph"
    pairs: list[Four] = Field(default_factory=list, max_length=200)
    """Picked points: x and y in the image of ``from``, then in that of ``to``, pixels."""
    transform: Six | None = None
    """x y z in metres, roll pitch yaw in degrees, from ``from`` to ``to``."""
    sigmas: Six | None = None
    """Of the same axes; 0 where nothing is known."""
    author: Author = ""
    force: bool = False
    """Although the points or the graph object."""
    preview: bool = False
    """Only say what it would do."""

    @model_validator(mode="after")
    def _is_whole(self) -> LinkEdit:
        if self.action == "edit" and (self.transform is None or self.sigmas is None):
            raise ValueError("edit needs transform and sigmas, six numbers each")
        if self.action == "points" and len(self.pairs) < 3:
            raise ValueError("points needs at least 3 pairs")
        return self


class IcpFacts(Schema):
    """What clouds said."""

    ratio: float
    """Share of the points of the larger cloud that have a partner."""
    translation_m: float
    """Length of the correction of the guess."""
    rotation_deg: float
    complexity: float
    points: int


class EditedLink(Schema):
    """A link as it is, or would be."""

    from_: int = Field(alias="from")
    to: int
    type: str
    transform: PoseList
    angles_deg: Annotated[list[float], Field(min_length=3, max_length=3)]
    """Roll, pitch, yaw."""
    sigmas: Six
    """x y z in metres, roll pitch yaw in degrees."""


class LinkEditResult(Schema):
    """What came of an edit, or would."""

    link: EditedLink | None
    """None where nothing was found."""
    matches: int | None
    inliers: int | None
    icp: IcpFacts | None
    residuals_m: list[float] | None
    """How far each picked point is off."""
    reason: LoopReason | None
    """What speaks against it."""
    decision: DecisionResult | None
    """What it does to the map; None where there is no link."""


class NodeDrop(Schema):
    """Nodes that leave the map, by id or from one to another."""

    nodes: list[Id] = Field(default_factory=list, max_length=100_000)
    first: Id | None = None
    last: Id | None = None
    author: Author = ""
    preview: bool = False

    @model_validator(mode="after")
    def _names_some(self) -> NodeDrop:
        if (self.first is None) != (self.last is None) or (self.first is None) == (not self.nodes):
            raise ValueError("name nodes, or the first and the last of a stretch")
        return self


class NodeLabel(Schema):
    """A node's label; empty takes it away."""

    label: Annotated[str, Field(max_length=200)]
    author: Author = ""


class NodeLabels(NodeLabel):
    """A label for several nodes, numbered in the order of their ids; empty takes theirs away."""

    nodes: Annotated[list[Id], Field(min_length=1, max_length=100_000)]
    preview: bool = False


class NodePrior(Schema):
    """What a node's prior is to be."""

    transform: Six | None = None
    """x y z in metres, roll pitch yaw in degrees, map frame; null takes the prior away."""
    sigmas: Six | None = None
    """Of the same axes, in the frame of the node; three zeros for the angles: only the position is known."""
    count: bool = False
    """Switch ``Optimizer/PriorsIgnored`` off where it is on, so that priors move poses; undo switches it on again."""
    author: Author = ""
    preview: bool = False

    @model_validator(mode="after")
    def _is_whole(self) -> NodePrior:
        if (self.transform is None) != (self.sigmas is None):
            raise ValueError("a prior needs transform and sigmas, six numbers each, or neither to take it away")
        return self


class NodePriorState(Schema):
    """The prior of a node as it is."""

    transform: Six | None
    """As in NodePrior; null where the node has none."""
    sigmas: Six | None
    suggested: Six
    """Where the node is now."""
    ignored: bool
    """Whether ``Optimizer/PriorsIgnored`` is on, so that no prior moves anything."""


class LinkChoice(Schema):
    """Which links."""

    types: list[LinkTypeName] = Field(default_factory=list)
    """None for all links between two nodes; landmarks only where they are named."""
    first: Annotated[int, Field(ge=0)] = 0
    last: Annotated[int, Field(ge=0)] = 0
    """Ids of nodes; 0 for no limit."""
    intra: bool = True
    inter: bool = True
    session: Annotated[int, Field(ge=-1)] = -1
    """Only links of a node of this session; -1 for all."""


class Covariances(LinkChoice):
    """Covariances for many links."""

    sigmas: Six
    """x y z in metres, roll pitch yaw in degrees; 0 where nothing is known."""
    author: Author = ""
    preview: bool = False


class DetectOptions(Schema):
    """More loop closures: what is looked for."""

    radius_m: Annotated[float, Field(gt=0, le=1000)] = 1.0
    min_radius_m: Annotated[float, Field(ge=0, le=1000)] = 0.0
    angle_deg: Annotated[float, Field(ge=0, le=180)] = 30.0
    iterations: Annotated[int, Field(ge=1, le=100)] = 5
    min_graph_distance: Annotated[int, Field(ge=0, le=100_000)] = 10
    """Fewest links between two nodes of one session."""
    intra: bool = True
    inter: bool = True
    session: Annotated[int, Field(ge=-1)] = -1
    """Only pairs with a node of this session; -1 for all."""
    method: MethodName = "visual"
    guess: GuessName = "none"


class RefineOptions(LinkChoice):
    """Links to register anew, from what they say."""

    method: MethodName = "visual"
    covariance_only: bool = False


class RegridOptions(Schema):
    """Local grids to make anew."""

    changes: dict[str, bool | int | float | str] = Field(default_factory=dict, max_length=100)
    """Parameters of the group ``Grid/`` that differ from those of the map."""
    first: Annotated[int, Field(ge=0)] = 0
    last: Annotated[int, Field(ge=0)] = 0
    """Ids of nodes; 0 for no limit."""
    session: Annotated[int, Field(ge=-1)] = -1
    """Only nodes of this session; -1 for all."""


class StartJob(Schema):
    """Long work on a map: one of three."""

    detect: DetectOptions | None = None
    refine: RefineOptions | None = None
    regrid: RegridOptions | None = None
    author: Author = ""

    @model_validator(mode="after")
    def _is_one(self) -> StartJob:
        if sum(one is not None for one in (self.detect, self.refine, self.regrid)) != 1:
            raise ValueError("name one job: detect, refine or regrid")
        return self


class Job(Schema):
    """The last long work on a map."""

    id: int
    kind: JobKind
    state: Literal["running", "done", "cancelled", "failed"]
    share: float
    """0 to 1."""
    log: list[str]
    """The last lines."""
    message: str
    """Why it failed."""
    decision: DecisionResult | None
    """What it did to the map; None while it runs, and where it changed nothing."""


class JobStatus(Schema):
    """The last job of a map, if there was one."""

    job: Job | None
