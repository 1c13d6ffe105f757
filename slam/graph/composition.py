"""Links put together: what two of them, over a node between, say of the nodes at the ends."""

from __future__ import annotations

import numpy as np

from slam.geometry import Pose, adjoint, inverse
from slam.types import Link, LinkType


def composed(first: Link, second: Link, a: int, middle: int, b: int, kind: LinkType) -> Link:
    """The link from a to b over a node between: transforms one after the other, covariances added at the end."""
    T_a_middle, T_middle_b = directed(first, a), directed(second, middle)
    turn = adjoint(inverse(T_middle_b))
    covariance = turn @ np.linalg.inv(first.information) @ turn.T + np.linalg.inv(second.information)
    information = np.linalg.inv(covariance)
    return Link(a, b, kind, T_a_middle @ T_middle_b, 0.5 * (information + information.T))


def directed(link: Link, from_id: int) -> Pose:
    """The transform of a link as seen from one of its ends."""
    assert link.T_from_to is not None
    return link.T_from_to if link.from_id == from_id else inverse(link.T_from_to)
