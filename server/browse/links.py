"""A link, or a candidate that did not become one, with its evidence in numbers and words."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from server.browse.columns import number, pose_list
from server.browse.explain import explain
from server.browse.loops import doubt, evidence, loop_state, reason, rival
from server.browse.snapshot import Pair, Snapshot
from server.errors import NotFoundError
from server.schemas import LinkDetail
from slam.geometry import Array, rotation_angle, translation_norm
from slam.graph.optimizer import chi2
from slam.types import UNKNOWN_VARIANCE, Candidate, Link


def link_detail(
    snapshot: Snapshot, from_id: int, to_id: int, tried: Mapping[Pair, Candidate] | None = None
) -> LinkDetail:
    """All that is known of a pair; raises NotFoundError when it is neither linked nor was looked at.

    Args:
        snapshot: of the map.
        from_id: of either node.
        to_id: of the other.
        tried: what was registered since to see what another threshold would mean.
    """
    pair = (min(from_id, to_id), max(from_id, to_id))
    candidate = _candidate(snapshot, pair) or (tried or {}).get(pair)
    link = snapshot.links.get(pair) or _as_link(candidate) or _removed(snapshot, pair)
    if link is None:
        raise NotFoundError(f"nodes {from_id} and {to_id} are not linked, and no loop between them was looked at")
    T_from_to = link.T_from_to
    sigmas = _sigmas(link.information) if T_from_to is not None else None
    return LinkDetail(
        from_=link.from_id,
        to=link.to_id,
        type=link.type.label,
        state=loop_state(snapshot, pair),
        transform=pose_list(T_from_to),
        translation_m=None if T_from_to is None else translation_norm(T_from_to),
        rotation_deg=None if T_from_to is None else float(np.degrees(rotation_angle(T_from_to))),
        sigma_m=None if sigmas is None else sigmas[:3].tolist(),
        sigma_deg=None if sigmas is None else np.degrees(sigmas[3:]).tolist(),
        residual_sigma=number(snapshot.residuals.get(pair)),
        chi2=_chi2(snapshot, pair),
        chi2_share=_chi2_share(snapshot, pair),
        doubt=doubt(snapshot, pair),
        posterior=None if candidate is None else number(candidate.posterior),
        inliers=None if candidate is None else evidence(candidate.inliers),
        matches=None if candidate is None else evidence(candidate.matches),
        reason=None if candidate is None else reason(candidate.refusal),
        look_alike=rival(snapshot, pair),
        covariance=None if T_from_to is None else _covariance(link.information),
        update=_update(snapshot, pair, candidate),
        explanation=explain(snapshot, pair, link, candidate),
    )


def measured_link(snapshot: Snapshot, pair: Pair) -> Link | None:
    """What was measured between two nodes, in the graph or not; None where nothing was."""
    return snapshot.links.get(pair) or _as_link(_candidate(snapshot, pair)) or _removed(snapshot, pair)


def _candidate(snapshot: Snapshot, pair: Pair) -> Candidate | None:
    row = snapshot.candidates.get(pair)
    return None if row is None else row.candidate


def _as_link(candidate: Candidate | None) -> Link | None:
    if candidate is None:
        return None
    information = np.eye(6) if candidate.information is None else candidate.information
    return Link(candidate.from_id, candidate.to_id, candidate.type, candidate.T_from_to, information)


def _removed(snapshot: Snapshot, pair: Pair) -> Link | None:
    """The link that a decision took out of the graph."""
    entry = snapshot.history.last(pair)
    return None if entry is None else entry.link_before


def _sigmas(information: Array) -> Array | None:
    """Standard deviations (6,) in metres and radians; None when the matrix says nothing."""
    if np.linalg.matrix_rank(information) < 6:
        return None
    variances = np.diagonal(np.linalg.inv(information))
    if not (variances > 0).all():
        return None
    return np.sqrt(np.minimum(variances, UNKNOWN_VARIANCE))


def _covariance(information: Array) -> list[list[float]] | None:
    """The whole matrix; None when it says nothing about an axis."""
    if np.linalg.matrix_rank(information) < 6:
        return None
    return [[float(value) for value in row] for row in np.linalg.inv(information)]


def _update(snapshot: Snapshot, pair: Pair, candidate: Candidate | None) -> int | None:
    row = snapshot.candidates.get(pair)
    if row is not None:
        return row.update_id
    return None if candidate is None else candidate.from_id


def _chi2_share(snapshot: Snapshot, pair: Pair) -> float | None:
    own, whole = _chi2(snapshot, pair), snapshot.chi2
    return None if own is None or whole <= 0 else own / whole


def _chi2(snapshot: Snapshot, pair: Pair) -> float | None:
    link = snapshot.links.get(pair)
    if link is None or link.T_from_to is None or not {link.from_id, link.to_id} <= snapshot.poses.keys():
        return None
    return chi2([link], snapshot.poses)
