"""Edits of links between the page's shapes and the engine's."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from server.browse.columns import number, pose_list
from server.browse.journal import decision_result
from server.browse.loops import reason
from server.browse.nodes import require_node
from server.browse.snapshot import Snapshot
from server.schemas import Covariances, EditedLink, IcpFacts, LinkEditResult, NodePrior, NodePriorState
from server.schemas import LinkEdit as LinkEditBody
from slam.edit.priors import prior_of
from slam.edit.wishes import CovarianceEdit, LinkEdit, Matching, Outcome, PickedPair, PriorEdit
from slam.geometry import Array, Pose, from_euler_rpy, to_euler_rpy
from slam.types import UNKNOWN_VARIANCE, IcpEvidence, Link, LinkType


def wanted_edit(body: LinkEditBody, author: str) -> LinkEdit:
    """What the engine is asked for: radians and matrices."""
    return LinkEdit(
        action=body.action,
        from_id=body.from_,
        to_id=body.to,
        how=Matching(body.method, body.guess),
        pairs=tuple(PickedPair(tuple(pair.from_), tuple(pair.to)) for pair in body.pairs),
        T_from_to=_typed(body.transform),
        sigmas=None if body.sigmas is None else _sigmas(body.sigmas),
        author=author,
        force=body.force,
    )


def wanted_prior(node_id: int, body: NodePrior, author: str) -> PriorEdit:
    """What the engine is asked for."""
    sigmas = None if body.sigmas is None else _sigmas(body.sigmas)
    T_map_base = _typed(body.transform)
    return PriorEdit(node_id=node_id, T_map_base=T_map_base, sigmas=sigmas, count=body.count, author=author)


def wanted_covariances(body: Covariances, author: str) -> CovarianceEdit:
    """What the engine is asked for."""
    chosen = body.model_dump(include={"first", "last", "intra", "inter", "session"})
    return CovarianceEdit(types=link_types(body.types), sigmas=_sigmas(body.sigmas), author=author, **chosen)


def link_types(names: Sequence[str]) -> tuple[LinkType, ...]:
    """Kinds of links by the names that RTAB-Map prints."""
    kinds = {kind.label: kind for kind in LinkType}
    return tuple(kinds[name] for name in names)


def prior_state(snapshot: Snapshot, node_id: int, *, ignored: bool) -> NodePriorState:
    """The prior of a node of the map, and where the node is; raises NotFoundError without the node."""
    require_node(snapshot, node_id)
    here = prior_of(snapshot.graph, node_id)
    known = None if here is None or here.T_from_to is None else _six(here.T_from_to)
    return NodePriorState(
        transform=known,
        sigmas=None if here is None or known is None else _sigma_list(here),
        suggested=_six(snapshot.graph.poses[node_id]),
        ignored=ignored,
    )


def _typed(numbers: Sequence[float] | None) -> Pose | None:
    return None if numbers is None else from_euler_rpy(np.radians(numbers[3:]), np.array(numbers[:3]))


def _six(T: Pose) -> list[float]:
    return [*T[:3, 3].tolist(), *np.degrees(to_euler_rpy(T)).tolist()]


def _sigmas(numbers: Sequence[float]) -> Array:
    return np.concatenate([numbers[:3], np.radians(numbers[3:])])


def edit_result(outcome: Outcome, revision: int | None) -> LinkEditResult:
    """What came of it, as the page gets it; without a revision what it would do."""
    found = outcome.registration
    return LinkEditResult(
        link=None if outcome.link is None else _link(outcome.link),
        matches=None if found is None else len(found.matches),
        inliers=None if found is None else int(found.inliers.sum()),
        icp=None if found is None or found.icp is None else _icp(found.icp),
        residuals_m=None if outcome.residuals_m is None else outcome.residuals_m.tolist(),
        reason=reason(outcome.refusal),
        decision=None if outcome.effect is None else decision_result(outcome.effect, revision),
    )


def _link(link: Link) -> EditedLink | None:
    pose = pose_list(link.T_from_to)
    if link.T_from_to is None or pose is None:
        return None
    return EditedLink(
        from_=link.from_id,
        to=link.to_id,
        type=link.type.label,
        transform=pose,
        angles_deg=np.degrees(to_euler_rpy(link.T_from_to)).tolist(),
        sigmas=_sigma_list(link),
    )


def _sigma_list(link: Link) -> list[float]:
    """x y z in metres, roll pitch yaw in degrees; what is not known is typed as 0."""
    variances = np.minimum(np.diagonal(np.linalg.inv(link.information)), UNKNOWN_VARIANCE)
    sigmas = np.sqrt(np.maximum(variances, 0.0))
    sigmas[variances >= UNKNOWN_VARIANCE * (1 - 1e-6)] = 0.0
    return [*sigmas[:3].tolist(), *np.degrees(sigmas[3:]).tolist()]


def _icp(found: IcpEvidence) -> IcpFacts:
    return IcpFacts(
        ratio=found.ratio,
        translation_m=found.translation_m,
        rotation_deg=float(np.degrees(found.rotation_rad)),
        complexity=number(found.complexity) or 0.0,
        points=found.points,
    )
