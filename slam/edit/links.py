"""Links by hand: add, refine, edit, reset; first as a proposal with its evidence, then done."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slam.database import JournalEntry, MapReader
from slam.edit.matching import around, information_of, matched
from slam.edit.objection import objection
from slam.edit.point_pairs import Fitted, fitted, lifted
from slam.edit.sigmas import information_of_sigmas
from slam.edit.views import StoredViews
from slam.edit.wishes import LinkEdit, Outcome, PickedPair
from slam.errors import DecisionError
from slam.geometry import inverse
from slam.graph.graph import PoseGraph, name
from slam.review import Review
from slam.types import Link, LinkType, Refusal, Registration


class LinkEditor:
    """Edits links of a map file; every edit is journalled and can be undone."""

    def __init__(self, review: Review, reader: MapReader) -> None:
        self.views = StoredViews(reader)
        self._review = review
        self._reader = reader

    def preview(self, edit: LinkEdit) -> Outcome:
        """What an edit would do; nothing is changed.

        Raises:
            DecisionError: it makes no sense for these nodes.
        """
        proposed = self._proposed(edit)
        if proposed.link is None:
            return proposed
        against = proposed.refusal or self._objection(proposed.link)
        effect = self._review.change([self._entry(edit, proposed.link)], preview=True)
        return replace(proposed, refusal=against, effect=effect)

    def carry_out(self, edit: LinkEdit) -> Outcome:
        """Do it.

        Raises:
            DecisionError: it makes no sense for these nodes, nothing was found, or the points or the graph speak
                against it and it is not forced.
            DatabaseError: it can't be written.
        """
        proposed = self._proposed(edit)
        against = proposed.refusal
        if proposed.link is None:
            what = "" if against is None else against.text
            raise DecisionError(f"no link between {edit.from_id} and {edit.to_id} was found: {what}")
        if against is None and not edit.force:
            against = self._objection(proposed.link)
        if against is not None and not edit.force:
            raise DecisionError(f"link {name(proposed.link)} was not taken: {against.text}; it can be forced")
        return replace(proposed, refusal=against, effect=self._review.change([self._entry(edit, proposed.link)]))

    def _proposed(self, edit: LinkEdit) -> Outcome:
        here = _known(self._review.graph, edit)
        if edit.action in ("add", "points") and here is not None:
            raise DecisionError(f"nodes are joined by link {name(here)} already: refine or edit that one")
        if edit.action in ("refine", "reset") and here is None:
            raise DecisionError(f"nodes {edit.from_id} and {edit.to_id} are not linked: add a link first")
        if edit.action == "edit":
            return Outcome(_typed(edit, here))
        if edit.action == "points":
            return self._by_points(edit)
        if here is None:
            return self._by_registration(edit)
        return self._refined(edit, here) if edit.action == "refine" else Outcome(self._original(here))

    def _by_registration(self, edit: LinkEdit) -> Outcome:
        new, old = max(edit.from_id, edit.to_id), min(edit.from_id, edit.to_id)
        found = matched(self.views, self._review.graph, new, old, edit.how, self._review.params)
        return _found(found, Link(new, old, LinkType.USER_CLOSURE, None, np.eye(6)))

    def _refined(self, edit: LinkEdit, here: Link) -> Outcome:
        guess, method = here.T_from_to, edit.how.method
        return _found(around(self.views, here.from_id, here.to_id, guess, method, self._review.params), here)

    def _by_points(self, edit: LinkEdit) -> Outcome:
        new, old = max(edit.from_id, edit.to_id), min(edit.from_id, edit.to_id)
        pairs = edit.pairs if edit.from_id == new else [PickedPair(one.at_to, one.at_from) for one in edit.pairs]
        found = fitted(*lifted(self._reader, new, old, pairs))
        link = Link(new, old, LinkType.USER_CLOSURE, found.T_from_to, found.information)
        return Outcome(link, residuals_m=found.residuals_m, refusal=self._apart(found))

    def _apart(self, found: Fitted) -> Refusal | None:
        test, limit = "Vis/InlierDistance", self._review.params.Vis.InlierDistance
        worst = float(found.residuals_m.max())
        if worst <= limit:
            return None
        pair = int(np.argmax(found.residuals_m)) + 1
        return Refusal(test, worst, limit, f"pair {pair} is {worst:.3f} m off, more than {test} {limit:g} m")

    def _original(self, here: Link) -> Link:
        original = self._review.original(here.pair)
        if original is None:
            raise DecisionError(f"link {name(here)} is as it was made: nobody has edited it")
        return original

    def _objection(self, link: Link) -> Refusal | None:
        graph = self._review.graph
        return objection(graph, [link], self._review.params, [link.pair] if link.pair in graph.links else [])

    def _entry(self, edit: LinkEdit, link: Link) -> JournalEntry:
        here = self._review.graph.links.get(link.pair)
        action = edit.action if here is not None else "add"
        note = {"add": f"matched: {edit.how.method}", "points": f"{len(edit.pairs)} picked points", "edit": "typed"}
        return JournalEntry(
            action=action,
            from_id=link.from_id,
            to_id=link.to_id,
            author=edit.author,
            link_before=here,
            link_after=link,
            note=note.get(edit.action, edit.how.method if edit.action == "refine" else ""),
        )


def _known(graph: PoseGraph, edit: LinkEdit) -> Link | None:
    """The link of both nodes; raises DecisionError where they can't have one."""
    if edit.from_id == edit.to_id:
        raise DecisionError(f"node {edit.from_id} can't be linked with itself: name two nodes")
    for node_id in (edit.from_id, edit.to_id):
        if node_id not in graph:
            raise DecisionError(f"node {node_id} is not in the map")
    return graph.links.get((min(edit.from_id, edit.to_id), max(edit.from_id, edit.to_id)))


def _found(found: Registration, like: Link) -> Outcome:
    if found.T_from_to is None:
        return Outcome(None, found, refusal=found.refusal)
    return Outcome(replace(like, T_from_to=found.T_from_to, information=information_of(found)), found)


def _typed(edit: LinkEdit, here: Link | None) -> Link:
    if edit.T_from_to is None or edit.sigmas is None:
        raise DecisionError("an edit needs a transform and six sigmas")
    if not np.isfinite(edit.T_from_to).all():
        raise DecisionError("a transform must be of finite numbers")
    from_id, to_id = max(edit.from_id, edit.to_id), min(edit.from_id, edit.to_id)
    kind = LinkType.USER_CLOSURE
    if here is not None:
        from_id, to_id, kind = here.from_id, here.to_id, here.type
    T = edit.T_from_to if from_id == edit.from_id else inverse(edit.T_from_to)
    return Link(from_id, to_id, kind, T, information_of_sigmas(edit.sigmas))
