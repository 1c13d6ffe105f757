"""What a registration looks at, and the one method that every kind of registration has."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np

from slam.camera import Camera
from slam.geometry import Pose
from slam.params import Params
from slam.types import UNKNOWN_VARIANCE, Features, Images, Node, Refusal, Registration, Scan


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """One side of a registration; scan and images where they are at hand."""

    features: Features
    camera: Camera
    scan: Scan | None = None
    images: Images | None = None

    @classmethod
    def of(cls, node: Node) -> Self:
        """A node as a registration sees it."""
        return cls(node.features, node.camera, node.scan, node.images)


class Registrar(Protocol):
    """Aligns two views."""

    def register(self, view_from: View, view_to: View, guess: Pose | None, params: Params) -> Registration:
        """``T_from_to`` with its evidence, or the test that refused it.

        Args:
            view_from: the frame of the result.
            view_to: whose pose is looked for.
            guess: a first ``T_from_to``, if there is one.
            params: the Reg, Vis and Icp groups are read.
        """
        ...


def refused(refusal: Refusal) -> Registration:
    """The outcome of a registration that did not come as far as matches."""
    covariance = np.eye(6) * UNKNOWN_VARIANCE
    return Registration(None, covariance, np.zeros((0, 2), np.int32), np.zeros(0, np.bool_), refusal)
