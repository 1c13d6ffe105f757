"""Covariances of many links, typed: how far the map trusts its neighbours, its loops, its landmarks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slam.database import JournalEntry
from slam.edit.choice import chosen, sightings
from slam.edit.sigmas import information_of_sigmas
from slam.edit.wishes import CovarianceEdit
from slam.errors import DecisionError
from slam.graph.graph import PoseGraph


def weighing(graph: PoseGraph, wanted: CovarianceEdit) -> list[JournalEntry]:
    """Entries that give the chosen links these sigmas; those that have them already are left alone.

    Raises:
        DecisionError: no link is like that, all have these sigmas, or the sigmas are none.
    """
    information = information_of_sigmas(wanted.sigmas)
    links = [*chosen(graph, wanted), *sightings(graph, wanted)]
    if not links:
        raise DecisionError("no link is of these types, nodes and sessions: no covariance would change")
    changed = [link for link in links if not np.array_equal(link.information, information)]
    if not changed:
        raise DecisionError(f"all {len(links)} links have these sigmas already")
    return [
        JournalEntry(
            action="covariance",
            from_id=link.from_id,
            to_id=link.to_id,
            author=wanted.author,
            link_before=link,
            link_after=replace(link, information=information),
            note="sigmas typed",
        )
        for link in changed
    ]
