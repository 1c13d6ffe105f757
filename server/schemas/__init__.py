"""The only shapes that the page may see; its types are generated from them."""

from server.schemas.base import ErrorBody, ErrorDetail, ParameterValue, PoseList, RunState, Schema, Size
from server.schemas.decisions import Decision, DecisionAction, DecisionEffect, DecisionResult, Journal, JournalEntry
from server.schemas.graph import Graph, LinkColumns, NodeColumns
from server.schemas.links import LinkDetail, LinkMatches, LoopReason, LoopRow, Loops
from server.schemas.maps import Landmark, Landmarks, MapFacts, MapInfo, Maps, MapSummary, SessionFacts
from server.schemas.nodes import (
    CameraModel,
    CloudFacts,
    GpsFix,
    GridFacts,
    NodeDetail,
    NodeFeatures,
    NodeLink,
    NodePage,
    NodeRow,
    NodeSensors,
    SensorReading,
    UserData,
    Vector,
)
from server.schemas.parameters import Parameter, ParameterChanges, ParameterSet
from server.schemas.scene import Colouring, LayerChange, Scene, SceneChange, SceneLayers
from server.schemas.session import Session, SessionCommand, StartRun
from server.schemas.statistics import Hypothesis, StatisticNames, Statistics

__all__ = [
    "CameraModel",
    "CloudFacts",
    "Colouring",
    "Decision",
    "DecisionAction",
    "DecisionEffect",
    "DecisionResult",
    "ErrorBody",
    "ErrorDetail",
    "GpsFix",
    "Graph",
    "GridFacts",
    "Hypothesis",
    "Journal",
    "JournalEntry",
    "Landmark",
    "Landmarks",
    "LayerChange",
    "LinkColumns",
    "LinkDetail",
    "LinkMatches",
    "LoopReason",
    "LoopRow",
    "Loops",
    "MapFacts",
    "MapInfo",
    "MapSummary",
    "Maps",
    "NodeColumns",
    "NodeDetail",
    "NodeFeatures",
    "NodeLink",
    "NodePage",
    "NodeRow",
    "NodeSensors",
    "Parameter",
    "ParameterChanges",
    "ParameterSet",
    "ParameterValue",
    "PoseList",
    "RunState",
    "Scene",
    "SceneChange",
    "SceneLayers",
    "Schema",
    "SensorReading",
    "Session",
    "SessionCommand",
    "SessionFacts",
    "Size",
    "StartRun",
    "StatisticNames",
    "Statistics",
    "UserData",
    "Vector",
]
