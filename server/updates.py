"""What the page is told of each new node."""

from __future__ import annotations

from typing import Any

from server.browse.columns import number
from server.browse.loops import evidence, reason
from server.engine.events import NodeAdded
from slam.types import Candidate

#: The statistics that the page always shows; it fetches others when somebody looks at them.
SHOWN = (
    "Timing/Total/ms",
    "Loop/Highest_hypothesis_value/",
    "Loop/Accepted_hypothesis_id/",
    "Memory/Short_time_memory_size/",
    "Memory/Working_memory_size/",
    "Memory/Long_term_memory_size/",
    "Odometry/TotalTime/ms",
    "Odometry/Inliers/",
)


def update_message(event: NodeAdded) -> dict[str, Any]:
    """The ``update`` message of a node."""
    return {
        "id": event.node_id,
        "frame": event.frame,
        "stamp": event.stamp,
        "statistics": {name: number(event.statistics[name]) for name in SHOWN if name in event.statistics},
        "candidates": [_candidate(candidate) for candidate in event.candidates],
        "tiers": {str(node_id): tier.value for node_id, tier in event.tiers.items()},
        "optimized": event.optimized,
    }


def _candidate(candidate: Candidate) -> dict[str, Any]:
    why = reason(candidate.refusal)
    return {
        "from": candidate.from_id,
        "to": candidate.to_id,
        "type": candidate.type.label,
        "posterior": number(candidate.posterior),
        "inliers": evidence(candidate.inliers),
        "matches": evidence(candidate.matches),
        "reason": None if why is None else why.model_dump(),
    }
