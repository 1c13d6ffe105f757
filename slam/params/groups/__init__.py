"""The parameters that some code of slamdeck reads, by RTAB-Map's groups and names."""

from __future__ import annotations

from slam.params.groups.features import (
    ALIKEDGroup,
    BRIEFGroup,
    BRISKGroup,
    DISKGroup,
    FASTGroup,
    FREAKGroup,
    GFTTGroup,
    KAZEGroup,
    KpGroup,
    LightGlueGroup,
    ORBGroup,
    SIFTGroup,
    SURFGroup,
)
from slam.params.groups.graph import GTSAMGroup, OptimizerGroup
from slam.params.groups.grids import GridGlobalGroup, GridGroup
from slam.params.groups.odometry import OdomF2MGroup, OdomGroup
from slam.params.groups.registration import IcpGroup, RegGroup, VisGroup
from slam.params.groups.update import BayesGroup, MemGroup, RGBDGroup, RtabmapGroup, VhEpGroup

__all__ = [
    "ALIKEDGroup",
    "BRIEFGroup",
    "BRISKGroup",
    "BayesGroup",
    "DISKGroup",
    "FASTGroup",
    "FREAKGroup",
    "GFTTGroup",
    "GTSAMGroup",
    "GridGlobalGroup",
    "GridGroup",
    "IcpGroup",
    "KAZEGroup",
    "KpGroup",
    "LightGlueGroup",
    "MemGroup",
    "ORBGroup",
    "OdomF2MGroup",
    "OdomGroup",
    "OptimizerGroup",
    "RGBDGroup",
    "RegGroup",
    "RtabmapGroup",
    "SIFTGroup",
    "SURFGroup",
    "VhEpGroup",
    "VisGroup",
]
