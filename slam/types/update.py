"""All that one frame did to the map."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Pose
from slam.types.loop import Candidate, Posterior
from slam.types.node import Node, Tier
from slam.types.odometry import Odometry


@dataclass(frozen=True, slots=True, eq=False)
class Update:
    """All that ``Slam.process`` did with one frame.

    Attributes:
        frame_index: of the source.
        stamp: seconds.
        odometry: tracking result.
        T_map_base: (4, 4) pose in the map, None when lost; a guess while ``covariance`` is 9999.
        covariance: (6, 6) of that pose in axes of the map, m^2 and rad^2; only when localising in a finished map.
        node: the node that was added, None for a frame in between.
        weight: weight the node ended up with (-9 when it was merged or dropped).
        posterior: belief over WM, None where it was not computed.
        candidates: loop closures looked at, accepted and refused.
        tiers: id -> tier of the nodes whose tier changed in this update.
        optimized: whether poses of older nodes moved.
        statistics: RTAB-Map names -> values.
        time_ms: time the update took (without odometry).
    """

    frame_index: int
    stamp: float
    odometry: Odometry
    T_map_base: Pose | None
    node: Node | None = None
    weight: int = 0
    posterior: Posterior | None = None
    candidates: tuple[Candidate, ...] = ()
    tiers: Mapping[int, Tier] = field(default_factory=dict)
    optimized: bool = False
    statistics: Mapping[str, float] = field(default_factory=dict)
    time_ms: float = 0.0
    covariance: NDArray[np.float64] | None = None
