"""The only shapes that the page may see; its types are generated from them."""

from server.schemas.base import ErrorBody, ErrorDetail, ParameterValue, PoseList, RunState, Schema, Size
from server.schemas.decisions import Decision, DecisionAction, DecisionEffect, DecisionResult, Journal, JournalEntry
from server.schemas.graph import Graph, LinkColumns, NodeColumns
from server.schemas.links import LinkDetail, LinkMatches, LoopDoubt, LoopReason, LoopRow, Loops
from server.schemas.maps import MapFacts, MapInfo, Maps, MapSummary
from server.schemas.nodes import CameraModel, NodeDetail, NodeFeatures, NodeLink, NodePage, NodeRow
from server.schemas.parameters import Parameter, ParameterChanges, ParameterChoice, ParameterSet
from server.schemas.scene import Colouring, LayerChange, Scene, SceneChange, SceneLayers
from server.schemas.session import Session, SessionCommand, StartRun
from server.schemas.statistics import Hypothesis, StatisticNames, Statistics
from server.schemas.what_if import LoopWhatIf, WhatIfGraph, WhatIfLoop

__all__ = [
    "CameraModel",
    "Colouring",
    "Decision",
    "DecisionAction",
    "DecisionEffect",
    "DecisionResult",
    "ErrorBody",
    "ErrorDetail",
    "Graph",
    "Hypothesis",
    "Journal",
    "JournalEntry",
    "LayerChange",
    "LinkColumns",
    "LinkDetail",
    "LinkMatches",
    "LoopDoubt",
    "LoopReason",
    "LoopRow",
    "LoopWhatIf",
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
    "Parameter",
    "ParameterChanges",
    "ParameterChoice",
    "ParameterSet",
    "ParameterValue",
    "PoseList",
    "RunState",
    "Scene",
    "SceneChange",
    "SceneLayers",
    "Schema",
    "Session",
    "SessionCommand",
    "Size",
    "StartRun",
    "StatisticNames",
    "Statistics",
    "WhatIfGraph",
    "WhatIfLoop",
]
