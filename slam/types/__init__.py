"""The frozen values that the stages of the pipeline hand to each other."""

from __future__ import annotations

from slam.types.features import Descriptors, Features
from slam.types.frame import ExternalOdometry, Frame, Images, Scan
from slam.types.grid import LocalGrid, OccupancyGrid
from slam.types.link import UNKNOWN_VARIANCE, Link, LinkType
from slam.types.loop import Candidate, Posterior
from slam.types.node import WEIGHT_INTERMEDIATE, WEIGHT_INVALID, Node, Tier
from slam.types.odometry import Odometry, TrackedFrame
from slam.types.placement import KernelName, Manner, Placement, StartName
from slam.types.refusal import Refusal
from slam.types.registration import IcpEvidence, Registration
from slam.types.stored import Stored
from slam.types.update import Update

__all__ = [
    "UNKNOWN_VARIANCE",
    "WEIGHT_INTERMEDIATE",
    "WEIGHT_INVALID",
    "Candidate",
    "Descriptors",
    "ExternalOdometry",
    "Features",
    "Frame",
    "IcpEvidence",
    "Images",
    "KernelName",
    "Link",
    "LinkType",
    "LocalGrid",
    "Manner",
    "Node",
    "OccupancyGrid",
    "Odometry",
    "Placement",
    "Posterior",
    "Refusal",
    "Registration",
    "Scan",
    "StartName",
    "Stored",
    "Tier",
    "TrackedFrame",
    "Update",
]
