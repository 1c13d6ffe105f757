"""What a link's information matrix says in the units that people read."""

from __future__ import annotations

import numpy as np

from slam.geometry import Array
from slam.types import UNKNOWN_VARIANCE


def link_sigmas(information: Array) -> Array | None:
    """Standard deviations (6,) in metres and radians; None when the matrix says nothing."""
    if np.linalg.matrix_rank(information) < 6:
        return None
    variances = np.diagonal(np.linalg.inv(information))
    if not (variances > 0).all():
        return None
    return np.sqrt(np.minimum(variances, UNKNOWN_VARIANCE))


def link_covariance(information: Array) -> list[list[float]] | None:
    """The whole matrix; None when it says nothing about an axis."""
    if np.linalg.matrix_rank(information) < 6:
        return None
    return [[float(value) for value in row] for row in np.linalg.inv(information)]
