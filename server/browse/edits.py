"""Edits of links between the page's shapes and the engine's."""

from __future__ import annotations

import numpy as np

from server.browse.columns import number, pose_list
from server.browse.journal import decision_result
from server.browse.loops import reason
from server.schemas import EditedLink, IcpFacts, LinkEditResult
from server.schemas import LinkEdit as LinkEditBody
from slam.edit.wishes import LinkEdit, Matching, Outcome, PixelPair
from slam.geometry import from_euler_rpy, to_euler_rpy
from slam.types import UNKNOWN_VARIANCE, IcpEvidence, Link


def wanted_edit(body: LinkEditBody, author: str) -> LinkEdit:
    """What the engine is asked for: radians and matrices."""
    typed, sigmas = body.transform, body.sigmas
    return LinkEdit(
        action=body.action,
        from_id=body.from_,
        to_id=body.to,
        how=Matching(body.method, body.guess),
        pairs=tuple(PixelPair(*pair) for pair in body.pairs),
        T_from_to=None if typed is None else from_euler_rpy(np.radians(typed[3:]), np.array(typed[:3])),
        sigmas=None if sigmas is None else np.concatenate([sigmas[:3], np.radians(sigmas[3:])]),
        author=author,
        force=body.force,
    )


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
    variances = np.minimum(np.diagonal(np.linalg.inv(link.information)), UNKNOWN_VARIANCE)
    sigmas = np.sqrt(np.maximum(variances, 0.0))
    # What is not known is typed as 0.
    sigmas[variances >= UNKNOWN_VARIANCE * (1 - 1e-6)] = 0.0
    return EditedLink(
        from_=link.from_id,
        to=link.to_id,
        type=link.type.label,
        transform=pose,
        angles_deg=np.degrees(to_euler_rpy(link.T_from_to)).tolist(),
        sigmas=[*sigmas[:3].tolist(), *np.degrees(sigmas[3:]).tolist()],
    )


def _icp(found: IcpEvidence) -> IcpFacts:
    return IcpFacts(
        ratio=found.ratio,
        translation_m=found.translation_m,
        rotation_deg=float(np.degrees(found.rotation_rad)),
        complexity=number(found.complexity) or 0.0,
        points=found.points,
    )
