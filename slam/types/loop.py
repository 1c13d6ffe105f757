"""What loop closure detection believes and tries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Pose
from slam.types.link import Link, LinkType
from slam.types.refusal import Refusal


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A loop closure that was looked at, with its evidence; accepted when ``refusal`` is None.

    Attributes:
        from_id: the newer node.
        to_id: the older node.
        type: GLOBAL_CLOSURE or LOCAL_SPACE_CLOSURE.
        posterior: 1 - P(virtual place) for a global closure, NaN for a proximity one.
        matches: features matched; -1 when it was refused before matching; points compared when only scans were.
        inliers: matches that agree with the transform; -1 likewise; points that have a partner likewise.
        T_from_to: (4, 4) transform where the registration found one.
        information: (6, 6) where the registration found one.
        refusal: which test refused it.
        by_scans: whether only scans were compared.
    """

    from_id: int
    to_id: int
    type: LinkType
    posterior: float
    matches: int
    inliers: int
    T_from_to: Pose | None
    information: NDArray[np.float64] | None
    refusal: Refusal | None
    by_scans: bool = False

    @property
    def link(self) -> Link | None:
        """The link that it is or would be; None where the registration found no transform."""
        if self.T_from_to is None or self.information is None:
            return None
        return Link(self.from_id, self.to_id, self.type, self.T_from_to, self.information)


@dataclass(frozen=True, slots=True, eq=False)
class Posterior:
    """The Bayes filter's belief after one update.

    Attributes:
        node_ids: (N,) int32 places in WM, ascending.
        likelihood: (N,) adjusted likelihood.
        probability: (N,) posterior; with ``virtual_place`` it sums to one.
        virtual_place: probability of being nowhere known.
        virtual_likelihood: adjusted likelihood of that.
    """

    node_ids: NDArray[np.int32]
    likelihood: NDArray[np.float64]
    probability: NDArray[np.float64]
    virtual_place: float
    virtual_likelihood: float

    @property
    def best_id(self) -> int:
        """The most probable place, 0 when there is none."""
        return int(self.node_ids[int(np.argmax(self.probability))]) if len(self.node_ids) else 0

    @property
    def value(self) -> float:
        """What LoopThr is compared with: 1 - P(virtual place)."""
        return 1.0 - self.virtual_place if len(self.node_ids) else 0.0
