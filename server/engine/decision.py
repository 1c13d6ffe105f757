"""A person's decision, carried out by the review of whoever has the map open for writing."""

from __future__ import annotations

from server.engine.commands import Decide
from slam.effect import Effect
from slam.review import Review


def carry_out(review: Review, command: Decide) -> Effect:
    """Approve, reject, undo or redo, or only work out what that would do.

    Raises:
        DecisionError: it is not possible on this graph.
        DatabaseError: it can't be written.
    """
    if command.action == "undo":
        return review.undo(command.author, preview=command.preview)
    if command.action == "redo":
        return review.redo(command.author, preview=command.preview)
    return review.decide(command.action, command.loops, command.author, preview=command.preview, tried=command.tried)
