"""A person's decision, carried out by the review of whoever has the map open for writing."""

from __future__ import annotations

from server.engine.commands import Decide
from slam.review import Effect, Review


def carry_out(review: Review, command: Decide) -> Effect:
    """Approve, reject, undo or redo.

    Raises:
        DecisionError: it is not possible on this graph.
        DatabaseError: it can't be written.
    """
    if command.action == "approve":
        return review.approve(command.from_id, command.to_id, command.author)
    if command.action == "reject":
        return review.reject(command.from_id, command.to_id, command.author)
    return review.undo(command.author) if command.action == "undo" else review.redo(command.author)
