"""Which descriptors can be compared with each other."""

from __future__ import annotations

from slam.errors import ParameterError
from slam.types import Descriptors


def check_kind(known: Descriptors, descriptors: Descriptors) -> None:
    """Refuses descriptors that can't be compared with those known (both (N, B)).

    Raises:
        ParameterError: another type or width.
    """
    if known.dtype != descriptors.dtype or known.shape[1] != descriptors.shape[1]:
        raise ParameterError(
            f"descriptors of {descriptors.shape[1]} {descriptors.dtype} can't be compared with the map's of "
            f"{known.shape[1]} {known.dtype}: set Vis/FeatureType and Kp/DetectorStrategy to the types it was made with"
        )
