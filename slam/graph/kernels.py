"""Robust kernels: how much a loop counts that the rest of the graph contradicts."""

from __future__ import annotations

from enum import StrEnum

import gtsam

from slam.params import Params

#: 99 % of true measurements of so many axes have a smaller chi2 (quantiles of the chi2 distribution).
OUTLIER_CHI2 = {6: 16.812, 3: 11.345}


class Kernel(StrEnum):
    """What the factors of loop links are wrapped in.

    DCS is what is left of switchable constraints once each switch has its best value (Agarwal et al., "Robust Map
    Optimization using Dynamic Covariance Scaling", 2013). GNC reweighs from outside, its factors are plain.
    """

    NONE = "none"
    DCS = "DCS"
    CAUCHY = "Cauchy"
    GNC = "GNC"

    def wrap(self, noise: gtsam.noiseModel.Gaussian) -> gtsam.noiseModel.Base:
        """The noise of a loop link; a residual as large as a true one's expected chi2 is where weight begins to go."""
        axes = noise.dim()
        if self is Kernel.DCS:
            return gtsam.noiseModel.Robust.Create(gtsam.noiseModel.mEstimator.DCS.Create(float(axes)), noise)
        if self is Kernel.CAUCHY:
            return gtsam.noiseModel.Robust.Create(gtsam.noiseModel.mEstimator.Cauchy.Create(axes**0.5), noise)
        return noise


def choose_kernel(params: Params) -> Kernel:
    """The kernel that ``Optimizer/Robust`` and ``Optimizer/RobustKernel`` ask for."""
    return Kernel(params.Optimizer.RobustKernel) if params.Optimizer.Robust else Kernel.NONE
