"""The link to the node before, made better by registering both with odometry as the guess."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from slam.geometry import Pose, inverse
from slam.params import Params
from slam.registration.choice import registrar
from slam.registration.view import View
from slam.types import Link, Node, Registration

#: A link that could not be refined is trusted this much less, as in RTAB-Map.
_DOUBT = 100.0


@dataclass(frozen=True, slots=True, eq=False)
class Neighbor:
    """A node's link to the one before it, if it has one, and the registration that refined it, if that was tried."""

    link: Link | None = None
    refining: Registration | None = None

    @property
    def links(self) -> tuple[Link, ...]:
        """The link, as what an update adds to the graph."""
        return () if self.link is None else (self.link,)

    @property
    def refined(self) -> bool:
        """Whether the link is not odometry's any more."""
        return self.refining is not None and self.refining.T_from_to is not None

    def placed(self, T_map_last: Pose) -> Pose:
        """``T_map_new`` by the link, from the pose of the node before."""
        assert self.link is not None
        assert self.link.T_from_to is not None
        return np.asarray(T_map_last @ inverse(self.link.T_from_to))


def refine(link: Link, new: Node, last: Node, params: Params) -> Neighbor:
    """The link with transform and covariance of a registration, where ``RGBD/NeighborLinkRefining`` asks for it.

    Where the registration is refused, odometry's transform stays, with a hundred times its covariance.

    Args:
        link: from the new node to the last one, by odometry.
        new: the new node.
        last: the one before it.
        params: what ``Reg/Strategy`` reads.
    """
    if not params.RGBD.NeighborLinkRefining:
        return Neighbor(link)
    found = registrar(params).register(View.of(new), View.of(last), link.T_from_to, params)
    if found.T_from_to is None:
        return Neighbor(replace(link, information=link.information / _DOUBT), found)
    information = np.asarray(np.linalg.inv(found.covariance), np.float64)
    return Neighbor(replace(link, T_from_to=found.T_from_to, information=information), found)
