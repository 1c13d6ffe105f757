"""Why a link is in the graph, or is not, in plain words with the numbers that decided."""

from __future__ import annotations

import math

from server.browse.loops import taken_back
from server.browse.snapshot import Pair, Snapshot
from slam.database import JournalEntry
from slam.loop.aliasing import NEARLY
from slam.types import Candidate, Link, LinkType

_PLAIN = {
    LinkType.NEIGHBOR: "Neighbours in time: odometry measured this step.",
    LinkType.NEIGHBOR_MERGED: "Neighbours in time, joined when a node between them was merged.",
    LinkType.VIRTUAL_CLOSURE: "A virtual link, made to carry on a map.",
    LinkType.POSE_PRIOR: "A prior: the node's pose was measured from outside.",
    LinkType.LANDMARK: "A landmark seen from this node.",
    LinkType.GRAVITY: "Gravity: which way is up at this node.",
    LinkType.USER_CLOSURE: "Added by hand.",
    LinkType.LOCAL_TIME_CLOSURE: "A loop among the nodes of short-term memory.",
}

_EDITS = {
    "edit": "Its numbers were changed by hand",
    "covariance": "Its covariance was changed by hand",
    "refine": "It was registered anew",
}


def explain(snapshot: Snapshot, pair: Pair, link: Link, candidate: Candidate | None) -> str:
    """One or two sentences about a pair."""
    decided = snapshot.verdicts.get(pair)
    said = [] if decided is None else [_decision(decided)]
    verdict = "Accepted" if decided is None or decided.action != "reject" else "The engine had accepted it"
    if candidate is None or not link.type.is_loop:
        said.append(_PLAIN.get(link.type, "A loop closure; the file does not say what it was judged by."))
    elif decided is None and pair not in snapshot.links and taken_back(candidate):
        said.append(f"Found by a search for more loops that was taken back: {_grounds(snapshot, pair, candidate)}.")
    elif candidate.refusal is not None:
        said.append(f"Refused: {candidate.refusal.text.rstrip('.')}.")
    else:
        said.append(f"{verdict}: {_grounds(snapshot, pair, candidate)}.")
    return " ".join([*said, *_edit(snapshot, pair), *_suspect(snapshot, pair), *_rival(snapshot, pair)])


def _edit(snapshot: Snapshot, pair: Pair) -> list[str]:
    """Who gave the link other numbers than those that were measured."""
    entry = snapshot.history.edited(pair)
    done = None if entry is None else _EDITS.get(entry.action)
    return [] if entry is None or done is None else [_signed(done, entry)]


def _rival(snapshot: Snapshot, pair: Pair) -> list[str]:
    """Another place that looked the same, where it was nearly as likely."""
    found = snapshot.look_alike(pair)
    if found is None or found.share < NEARLY:
        return []
    how = "more likely" if found.share > 1.0 else f"{100 * found.share:.0f} % as likely"
    return [f"Look-alike: node {found.node_id}, {found.distance_m:.1f} m away, was {how} by its looks."]


def _suspect(snapshot: Snapshot, pair: Pair) -> list[str]:
    """What speaks against a loop, where it is enough to look at it again."""
    found = snapshot.suspicions.get(pair)
    if found is None or found.score < 1.0:
        return []
    parts = []
    if math.isfinite(found.odometry):
        parts.append(f"odometry alone is {found.odometry:.1f} sigma from it")
    if found.compared:
        parts.append(f"{found.agreeing} of {found.compared} loops near by agree with it")
    if math.isfinite(found.residual):
        parts.append(f"the map without the worst loops is {found.residual:.1f} sigma from it")
    return [f"Suspect: {', '.join(parts)}."]


def _grounds(snapshot: Snapshot, pair: Pair, candidate: Candidate) -> str:
    params = snapshot.params
    parts = []
    if math.isfinite(candidate.posterior):
        parts.append(f"hypothesis {candidate.posterior:.2f}, Rtabmap/LoopThr {params.Rtabmap.LoopThr:g}")
    else:
        parts.append("near by in the map (proximity)")
    if candidate.matches >= 0:
        parts.append(
            f"{candidate.inliers} inliers of {candidate.matches} matches, Vis/MinInliers {params.Vis.MinInliers} needed"
        )
    sigma = snapshot.residuals.get(pair)
    if sigma is not None:
        parts.append(f"residual {sigma:.1f} sigma, RGBD/OptimizeMaxError allows {params.RGBD.OptimizeMaxError:g}")
    return "; ".join(parts)


def _decision(entry: JournalEntry) -> str:
    return _signed({"approve": "Approved", "reject": "Rejected", "add": "Added by hand"}[entry.action], entry)


def _signed(done: str, entry: JournalEntry) -> str:
    return f"{done} by {entry.author} (decision {entry.id})." if entry.author else f"{done} (decision {entry.id})."
