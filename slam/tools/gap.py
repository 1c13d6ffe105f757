"""How sure odometry was of the way from one ordinary node to the next, as the file's links tell."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from slam.geometry import Array
from slam.types import UNKNOWN_VARIANCE, Link, LinkType


class Gap:
    """Adds up the links of odometry over intermediate nodes; nodes are asked for in the order of their ids."""

    def __init__(self, links: Iterable[Link]) -> None:
        self._to = {max(link.pair): link for link in links if link.type is LinkType.NEIGHBOR}
        self._so_far: dict[int, Array] = {}

    def to(self, node_id: int, *, ordinary: bool) -> Array:
        """(6, 6) covariance of the motion since the ordinary node before; 9999 where no link leads here."""
        link, found = self._to.get(node_id), np.eye(6) * UNKNOWN_VARIANCE
        if link is not None:
            found = covariance(link) + self._so_far.get(min(link.pair), np.zeros((6, 6)))
        self._so_far = {} if ordinary else {**self._so_far, node_id: found}
        return found


def covariance(link: Link) -> Array:
    """(6, 6) covariance of a link; only its diagonal where the information can't be inverted, at most 9999 each."""
    diagonal = np.maximum(np.nan_to_num(np.diagonal(link.information)), 1.0 / UNKNOWN_VARIANCE)
    try:
        found = np.asarray(np.linalg.inv(link.information), np.float64)
    except np.linalg.LinAlgError:
        return np.diag(1.0 / diagonal)
    sound = np.isfinite(found).all() and (np.diagonal(found) > 0).all()
    return found if sound and np.diagonal(found).max() <= UNKNOWN_VARIANCE else np.diag(1.0 / diagonal)
