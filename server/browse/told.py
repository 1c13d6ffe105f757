"""What RTAB-Map's statistics tell of its loops: it keeps no candidates, but the figures of each update."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from slam.database import StatisticsTable
from slam.types import Candidate, Link, LinkType

_ACCEPTED, _NEAR = "Loop/Accepted_hypothesis_id/", "Proximity/Space_last_detection_id/"
_BEST, _VALUE = "Loop/Highest_hypothesis_id/", "Loop/Highest_hypothesis_value/"
_INLIERS, _MATCHES = "Loop/Visual_inliers/", "Loop/Visual_matches/"


def told_by_statistics(
    table: StatisticsTable, links: Mapping[tuple[int, int], Link]
) -> dict[tuple[int, int], Candidate]:
    """The evidence of the loops that updates say they closed, by (older, newer).

    An update has one number of inliers: that of the hypothesis if it was accepted, else that of the loop near by. Its
    belief belongs to the hypothesis alone.

    Args:
        table: statistics of the file.
        links: of the graph; loops that are not in it any more are not told of.
    """
    rows = {int(node_id): row for row, node_id in enumerate(table.ids)}
    found = {}
    for pair, link in links.items():
        if link.type not in (LinkType.GLOBAL_CLOSURE, LinkType.LOCAL_SPACE_CLOSURE) or pair[1] not in rows:
            continue
        candidate = _candidate(table, rows[pair[1]], pair, link)
        if candidate is not None:
            found[pair] = candidate
    return found


def _candidate(table: StatisticsTable, row: int, pair: tuple[int, int], link: Link) -> Candidate | None:
    older, newer = pair
    accepted = _whole(table, _ACCEPTED, row)
    if older != (accepted if accepted > 0 else _whole(table, _NEAR, row)):
        return None
    matches, inliers = (_whole(table, name, row) for name in (_MATCHES, _INLIERS))
    by_belief = older == accepted == _whole(table, _BEST, row)
    return Candidate(
        from_id=newer,
        to_id=older,
        type=link.type,
        posterior=float(table.values[_VALUE][row]) if by_belief and _VALUE in table.values else float("nan"),
        matches=matches if matches > 0 else -1,
        inliers=inliers if matches > 0 else -1,
        T_from_to=link.T_from_to,
        information=link.information,
        refusal=None,
    )


def _whole(table: StatisticsTable, name: str, row: int) -> int:
    """A statistic that is a whole number; -1 where the update does not have it."""
    value = table.values[name][row] if name in table.values else np.nan
    return int(value) if np.isfinite(value) else -1
