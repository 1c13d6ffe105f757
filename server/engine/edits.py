"""Edits of links and nodes, and jobs, on a map that is open for writing."""

from __future__ import annotations

from server.engine.commands import (
    Change,
    DropNodes,
    Edit,
    EditCovariances,
    EditLink,
    EditPrior,
    KeepPoses,
    StartJob,
    TurnMap,
)
from slam.database import JournalEntry, MapReader
from slam.edit.covariances import weighing
from slam.edit.detect import detect_more
from slam.edit.grids import regrid
from slam.edit.job import Job
from slam.edit.links import LinkEditor
from slam.edit.nodes import dropping, labelling
from slam.edit.placements import optimising, turning
from slam.edit.priors import placing
from slam.edit.refine import refine_links
from slam.edit.wishes import Detection, Outcome, Regrid
from slam.effect import Effect
from slam.review import Review


class Edits:
    """Carries out what people want beyond verdicts on loops."""

    def __init__(self, review: Review, reader: MapReader) -> None:
        self._review = review
        self._reader = reader
        self._links = LinkEditor(review, reader)

    def carry_out(self, command: Edit) -> Outcome | Effect:
        """Do it, or work out what it would do.

        Raises:
            DecisionError: it is not possible on this map.
            DatabaseError: it can't be written.
        """
        if isinstance(command, EditLink):
            return self._links.preview(command.edit) if command.preview else self._links.carry_out(command.edit)
        return self.change(command)

    def change(self, command: Change) -> Effect:
        """The same for all but links by hand."""
        return self._review.change(self._entries(command), preview=command.preview)

    def _entries(self, command: Change) -> list[JournalEntry]:
        graph, params, reader = self._review.graph, self._review.params, self._reader
        if isinstance(command, KeepPoses):
            return [optimising(graph, params, command.wanted)]
        if isinstance(command, TurnMap):
            return [turning(graph, params, reader, command.wanted)]
        if isinstance(command, EditPrior):
            return [placing(graph, params, command.edit)]
        if isinstance(command, EditCovariances):
            return weighing(graph, command.edit)
        if isinstance(command, DropNodes):
            return dropping(graph, reader, command.node_ids, command.author)
        return labelling(graph, reader, command.node_ids, command.label, command.author)

    def job(self, command: StartJob) -> Job:
        """The work of a job, not begun."""
        if isinstance(command.wanted, Detection):
            return detect_more(self._review, self._links.views, command.wanted, command.author)
        if isinstance(command.wanted, Regrid):
            return regrid(self._review, self._reader, command.wanted, command.author)
        return refine_links(self._review, self._links.views, command.wanted, command.author)
