"""Many links registered anew: their transforms with their covariances, or the covariances alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from slam.database import JournalEntry
from slam.edit.choice import chosen
from slam.edit.job import Job, JobStep
from slam.edit.matching import around, information_of
from slam.edit.objection import tried
from slam.edit.views import StoredViews
from slam.edit.wishes import Refinement
from slam.errors import DatabaseError, DecisionError, OptimizationError
from slam.graph.graph import Pair, name
from slam.review import Review
from slam.types import Link


def refine_links(review: Review, views: StoredViews, wanted: Refinement, author: str = "") -> Job:
    """Refine links as one batch, which one undo takes back; a link whose registration is refused stays as it is.

    Links that the optimised graph then contradicts by more than ``RGBD/OptimizeMaxError`` stay as they were, too.

    Raises:
        DecisionError: no link is like that, or the graph can't live with the others.
        DatabaseError: it can't be written.
    """
    links, better = chosen(review.graph, wanted), dict[Pair, Link]()
    if not links:
        raise DecisionError("no link is of these types, nodes and sessions: nothing would be refined")
    for number, link in enumerate(links, 1):
        text = f"{name(link)}: "
        try:
            found = around(views, link.from_id, link.to_id, link.T_from_to, wanted.method, review.params)
        except (DecisionError, DatabaseError) as error:
            yield JobStep(number / (len(links) + 1), text + str(error))
            continue
        if found.T_from_to is None:
            yield JobStep(number / (len(links) + 1), text + ("refused" if not found.refusal else found.refusal.text))
            continue
        T = link.T_from_to if wanted.covariance_only else found.T_from_to
        better[link.pair] = replace(link, T_from_to=T, information=information_of(found))
        yield JobStep(number / (len(links) + 1), text + "refined")
    while better:
        blamed, text = _blamed(review, list(better.values()))
        if not text:
            break
        if blamed is None or blamed.pair not in better:
            raise DecisionError(f"the graph can't live with the {len(better)} refined links: {text}")
        del better[blamed.pair]
        yield JobStep(len(links) / (len(links) + 1), f"{name(blamed)} stays as it was: {text}")
    yield JobStep(1.0, f"{len(better)} of {len(links)} links refined")
    entries = [_entry(review.graph.links[pair], link, wanted, author) for pair, link in better.items()]
    return review.change(entries) if entries else None


def _blamed(review: Review, links: Sequence[Link]) -> tuple[Link | None, str]:
    """The link that speaks against these, and what it says; no text where the graph can live with them."""
    try:
        closure = tried(review.graph, links, review.params, [link.pair for link in links])
    except OptimizationError as error:
        return None, str(error)
    return closure.blamed, "" if closure.refusal is None else closure.refusal.text


def _entry(before: Link, after: Link, wanted: Refinement, author: str) -> JournalEntry:
    note = f"{wanted.method}, covariance alone" if wanted.covariance_only else wanted.method
    return JournalEntry(
        action="refine",
        from_id=before.from_id,
        to_id=before.to_id,
        author=author,
        link_before=before,
        link_after=after,
        note=note,
    )
