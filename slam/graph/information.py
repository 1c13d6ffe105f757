"""Information matrices that a solver can live with."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Array

#: Eigenvalues of information allowed; LM takes no step, without saying so, on graphs with wilder ones.
MIN_INFORMATION = 1e-6
MAX_INFORMATION = 1e9


def clamped(information: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Symmetric matrices (N, k, k) with eigenvalues within bounds, and which of them had others (N,).

    Gershgorin's circles spare most the decomposition.
    """
    diagonal = np.diagonal(information, axis1=1, axis2=2)
    radius = np.abs(information).sum(axis=2) - np.abs(diagonal)
    suspect = ((diagonal - radius).min(axis=1) < MIN_INFORMATION) | ((diagonal + radius).max(axis=1) > MAX_INFORMATION)
    wild = suspect.copy()
    if not suspect.any():
        return information, wild
    eigenvalues, vectors = np.linalg.eigh(information[suspect])
    wild[suspect] = (eigenvalues[:, 0] < MIN_INFORMATION) | (eigenvalues[:, -1] > MAX_INFORMATION)
    inside = eigenvalues.clip(MIN_INFORMATION, MAX_INFORMATION)
    fixed = (vectors * inside[:, None, :]) @ vectors.transpose(0, 2, 1)
    result = information.copy()
    result[wild] = fixed[wild[suspect]]
    return result, wild
