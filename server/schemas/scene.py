"""Shapes of the 3D view."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from server.schemas.base import Pair, Schema
from server.schemas.optimising import ShownOptimisation

#: ``memory``, ``session``, ``time``, ``weight``, or one of GET /api/maps/{map}/node-values.
Colouring = Annotated[str, Field(max_length=200)]
#: The measured transform of the link, or the optimised poses.
Overlay = Literal["link", "poses"]
#: Points of depth images, of scanners, or the key points that have a place.
OverlayPoints = Literal["cloud", "scan", "words"]
#: What the floor plan shows: free and occupied; free cells beside unknown ones too; how likely each is occupied.
GridLook = Literal["plan", "frontiers", "probability"]
#: Where nodes stand: where they are now, where they were at the moment shown, or there as soon as that is worked out.
Placing = Literal["now", "then", "soon"]
#: Links that are drawn alike; refused loops are links that never were.
LinkClass = Literal["neighbor", "loop", "proximity", "time", "user", "virtual", "refused", "landmark"]

#: What a node has to be seen close up.
NodePart = Literal["cloud", "mesh", "words", "scan", "grid", "elevation", "frustum"]


class DepthUse(Schema):
    """Which pixels of depth images become the cloud and the mesh of a node close up."""

    every: Literal[1, 2, 4, 8] = 1
    """Every so manieth of a row, and row."""
    far_m: Annotated[float, Field(ge=0, le=1000)] = 0.0
    """None farther away than this, metres; 0 for no limit."""
    edges: bool = True
    """Those at the edges of things as well, which may hang in the air behind them."""


class SceneLayers(Schema):
    """Which layers are shown."""

    graph: bool = True
    cloud: bool = True
    grid: bool = False
    odometry: bool = True
    truth: bool = False
    frusta: bool = False
    model: bool = False
    """The mesh or cloud that is stored with the map."""


class Scene(Schema):
    """State of a map's 3D view."""

    layers: SceneLayers
    colour: Colouring
    dark: bool = True
    selected_node: int | None = None
    selected_link: Pair | None = None
    node_parts: list[NodePart] = Field(default_factory=lambda: list[NodePart](["frustum"]))
    """What is shown of the selected node close up."""
    depth: DepthUse = Field(default_factory=DepthUse)
    """Of which pixels its cloud and its mesh are made."""
    alone: bool = False
    """Whether the selected node is shown without the map around it."""
    what_if: float | None = None
    """The ``Rtabmap/LoopThr`` whose loops and path are shown as ghosts."""
    trial: int | None = None
    """The trial whose loops and path are shown as ghosts, where no threshold's are."""
    overlay: Overlay | None = None
    """The clouds of both nodes of the selected link in two colours, and what places them, in place of all clouds."""
    overlay_of: OverlayPoints = "cloud"
    """Of what those clouds are; of a node without scans they are of depth images, and the other way round."""
    at: int | None = None
    """The node of the update that is shown; null for the map as it is now."""
    grid_as: GridLook = "plan"
    hidden_links: list[LinkClass] = Field(default_factory=list)
    hidden_sessions: list[int] = Field(default_factory=list)
    optimised: ShownOptimisation | None = None
    """An optimisation whose path is shown dashed beside the map's."""
    placing: Placing = "now"
    """Of a moment: whether its poses are those of then."""
    placing_note: str = ""
    """Why there are none of then."""
    revision: int = 0
    """Grows with each change, and from one server to the next."""


class LayerChange(Schema):
    """Layers to switch; those left out stay."""

    graph: bool | None = None
    cloud: bool | None = None
    grid: bool | None = None
    odometry: bool | None = None
    truth: bool | None = None
    frusta: bool | None = None
    model: bool | None = None


class SceneChange(Schema):
    """What to change; what is left out stays, null deselects, and as ``at`` goes back to now."""

    layers: LayerChange | None = None
    colour: Colouring | None = None
    dark: bool | None = None
    selected_node: int | None = None
    selected_link: Pair | None = None
    node_parts: list[NodePart] | None = None
    depth: DepthUse | None = None
    alone: bool | None = None
    what_if: Annotated[float, Field(ge=0, le=1)] | None = None
    trial: Annotated[int, Field(ge=1)] | None = None
    overlay: Overlay | None = None
    overlay_of: OverlayPoints | None = None
    at: Annotated[int, Field(ge=1)] | None = None
    grid_as: GridLook | None = None
    hidden_links: list[LinkClass] | None = None
    hidden_sessions: Annotated[list[int], Field(max_length=10_000)] | None = None
    optimised: ShownOptimisation | None = None
