"""Sigmas that a person types, and the information matrix that they are."""

from __future__ import annotations

import numpy as np

from slam.errors import DecisionError
from slam.geometry import Array
from slam.types import UNKNOWN_VARIANCE


def information_of_sigmas(sigmas: Array) -> Array:
    """(6, 6) diagonal information of (6,) sigmas, metres and radians; of an axis with 0 nothing is known.

    Raises:
        DecisionError: they are no finite numbers, one is below 0, or nothing would be known of any axis.
    """
    if not (np.isfinite(sigmas).all() and (sigmas >= 0).all()):
        raise DecisionError("sigmas must be finite numbers, not below 0")
    if not sigmas.any():
        raise DecisionError("all sigmas are 0, which says that nothing is known: one axis at least needs a sigma")
    return np.diag(1.0 / np.where(sigmas > 0, sigmas**2, UNKNOWN_VARIANCE))
