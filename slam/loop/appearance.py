"""Global loop closure: the Bayes filter names a place, the images decide."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from slam.geometry import translation_norm
from slam.loop.local_bundle import Beside, register_bundled
from slam.params import Params
from slam.registration.choice import registrar, then_icp
from slam.registration.view import View
from slam.types import Candidate, LinkType, Node, Posterior, Refusal, Registration


class AppearanceLoops:
    """Applies ``Rtabmap/LoopThr`` and ``LoopRatio`` to the posterior, then registers both nodes."""

    def __init__(self) -> None:
        self._last_value = 0.0

    def hypothesis(self, posterior: Posterior, *, connected: bool, params: Params) -> Refusal | None:
        """Why the best place is not tried, None when it is.

        Args:
            posterior: of this update.
            connected: whether the best place is joined to the current graph already.
            params: LoopThr, AggressiveLoopThr and LoopRatio are read.
        """
        previous, self._last_value = self._last_value, posterior.value
        aggressive = not connected and params.RGBD.AggressiveLoopThr < 1.0
        name = "RGBD/AggressiveLoopThr" if aggressive else "Rtabmap/LoopThr"
        threshold = params.RGBD.AggressiveLoopThr if aggressive else params.Rtabmap.LoopThr
        if len(posterior.node_ids) < 2:
            return Refusal("places", float(len(posterior.node_ids)), 2.0, "fewer than 2 places in working memory")
        if posterior.value < threshold:
            text = f"hypothesis {posterior.value:.3f} is below {name} {threshold:g}"
            return Refusal(name, posterior.value, threshold, text)
        least = params.Rtabmap.LoopRatio * previous
        if posterior.value < least:
            text = f"hypothesis {posterior.value:.3f} fell below Rtabmap/LoopRatio of the previous {previous:.3f}"
            return Refusal("Rtabmap/LoopRatio", posterior.value, least, text)
        return None


def verify(
    new: Node, old: Node, type: LinkType, posterior: float, params: Params, *, beside: Sequence[Beside] = ()
) -> Candidate:
    """Registers two nodes and puts the outcome, accepted or refused, into a candidate.

    Args:
        new: the newer node.
        old: the older one.
        type: of the link that may come of it.
        posterior: 1 - P(virtual place), NaN for proximity.
        params: what ``Reg/Strategy`` reads.
        beside: nodes beside the old one that help (``RGBD/LocalBundleOnLoopClosure``).
    """
    if beside:
        found = register_bundled(View.of(new), View.of(old), beside, params)
        found = found if params.Reg.Strategy == 0 else then_icp(found, View.of(new), View.of(old), params)
    else:
        found = registrar(params).register(View.of(new), View.of(old), None, params)
    refusal = found.refusal or _too_long(found, params)
    information = None if found.T_from_to is None else np.asarray(np.linalg.inv(found.covariance), np.float64)
    return Candidate(
        from_id=new.id,
        to_id=old.id,
        type=type,
        posterior=posterior,
        matches=len(found.matches),
        inliers=int(found.inliers.sum()),
        T_from_to=found.T_from_to,
        information=information,
        refusal=refusal,
    )


def _too_long(found: Registration, params: Params) -> Refusal | None:
    limit = params.RGBD.MaxLoopClosureDistance
    if found.T_from_to is None or limit == 0:
        return None
    length = translation_norm(found.T_from_to)
    if length <= limit:
        return None
    name = "RGBD/MaxLoopClosureDistance"
    return Refusal(name, length, limit, f"{length:.2f} m apart, farther than {name} {limit:g} m")
