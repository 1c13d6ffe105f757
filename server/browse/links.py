"""A link, or a candidate that did not become one, with its evidence in numbers and words."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from server.browse.columns import number, pose_list
from server.browse.explain import explain
from server.browse.link_noise import link_covariance, link_sigmas
from server.browse.link_walk import link_walk
from server.browse.loops import doubt, evidence, loop_state, reason, rival
from server.browse.sensors import user_data_facts
from server.browse.snapshot import Pair, Snapshot
from server.errors import NotFoundError
from server.schemas import KnownLink, LinkDetail
from slam.database.sensor_values import text_in
from slam.errors import DatabaseError
from slam.geometry import between, rotation_angle, translation_norm
from slam.graph.optimizer import chi2
from slam.types import Candidate, Link


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
    candidate = snapshot.looked_at(pair) or (tried or {}).get(pair)
    link = snapshot.links.get(pair) or _as_link(candidate) or _removed(snapshot, pair)
    if link is None:
        raise NotFoundError(f"nodes {from_id} and {to_id} are not linked, and no loop between them was looked at")
    T_from_to = link.T_from_to
    sigmas = link_sigmas(link.information) if T_from_to is not None else None
    ends = [snapshot.poses.get(node_id) for node_id in (link.from_id, link.to_id)]
    optimized = None if ends[0] is None or ends[1] is None else between(ends[0], ends[1])
    off = None if optimized is None or T_from_to is None else between(T_from_to, optimized)
    attached, problem = _attached(snapshot, pair)
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
        covariance=None if T_from_to is None else link_covariance(link.information),
        update=_update(snapshot, pair, candidate),
        explanation=explain(snapshot, pair, link, candidate),
        optimized=pose_list(optimized),
        off=pose_list(off),
        off_m=None if off is None else translation_norm(off),
        off_deg=None if off is None else float(np.degrees(rotation_angle(off))),
        merged_scans=_merged_scans(attached),
        user_data=user_data_facts(attached),
        problem=problem,
        scans=[node_id in snapshot.scanned for node_id in (link.from_id, link.to_id)],
        walk=link_walk(snapshot, pair, link.type),
    )


def known_link(
    snapshot: Snapshot, from_id: int, to_id: int, tried: Mapping[Pair, Candidate] | None = None
) -> KnownLink:
    """The same of any two ids: that there is nothing between them is an answer, too."""
    try:
        return KnownLink(link=link_detail(snapshot, from_id, to_id, tried), note="")
    except NotFoundError as error:
        absent = [node_id for node_id in (from_id, to_id) if node_id not in snapshot.rows]
        return KnownLink(link=None, note=f"node {absent[0]} is not in the map" if absent else str(error))


def measured_link(snapshot: Snapshot, pair: Pair) -> Link | None:
    """What was measured between two nodes, in the graph or not; None where nothing was."""
    return snapshot.links.get(pair) or _as_link(snapshot.looked_at(pair)) or _removed(snapshot, pair)


def _as_link(candidate: Candidate | None) -> Link | None:
    if candidate is None:
        return None
    information = np.eye(6) if candidate.information is None else candidate.information
    return Link(candidate.from_id, candidate.to_id, candidate.type, candidate.T_from_to, information)


def _removed(snapshot: Snapshot, pair: Pair) -> Link | None:
    """The link that a decision took out of the graph."""
    entry = snapshot.verdicts.get(pair)
    return None if entry is None else entry.link_before


def _attached(snapshot: Snapshot, pair: Pair) -> tuple[NDArray[np.generic] | None, str]:
    """User data of the link, or why they can't be read: the rest of the link can be looked at all the same."""
    try:
        return snapshot.reader.link_user_data(*pair), ""
    except DatabaseError as error:
        return None, f"user data: {error}"


def _merged_scans(attached: NDArray[np.generic] | None) -> list[int]:
    """Nodes that a link of merged scans names, as RTAB-Map writes them: ``SCANS:12;13;14``."""
    name, _, ids = (text_in(attached) or "").partition(":")
    return [int(part) for part in ids.split(";") if part.strip().isdigit()] if name == "SCANS" else []


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
