"""Reading what slamdeck alone records in a map file."""

from __future__ import annotations

from slam.database import update_rows
from slam.database.candidate_rows import read_candidates
from slam.database.deck_values import CandidateRow, LostFrame, ParameterChange, UpdateRow
from slam.database.faults import Faults
from slam.database.file_reader import FileReader
from slam.database.frame_rows import read_frames, read_lost_frames
from slam.database.guard import LARGE_VALUE
from slam.database.journal_rows import read_journal
from slam.database.parameter_rows import read_parameter_changes
from slam.database.poses_before import read_poses_before
from slam.database.records import JournalEntry
from slam.geometry import Pose
from slam.types import Posterior, TrackedFrame


class DeckReader(FileReader):
    """Updates, candidates, frames and decisions; all are empty for files that RTAB-Map wrote.

    Rows that make no sense are a DamagedRowError, or go to ``faults`` where that is given and all others are wanted.
    """

    def trajectory(self, faults: Faults | None = None) -> list[TrackedFrame]:
        """All tracked frames in the order of time."""
        with self._deck("reading the trajectory") as connection:
            return read_frames(connection, faults) if connection else []

    def lost_frames(self, faults: Faults | None = None) -> list[LostFrame]:
        """The frames that odometry lost, in the order of time."""
        with self._deck("reading the lost frames") as connection:
            return read_lost_frames(connection, faults) if connection else []

    def updates(self, after: int = 0, faults: Faults | None = None) -> list[UpdateRow]:
        """The updates after a node, ascending."""
        with self._deck("reading the updates") as connection:
            return update_rows.read_updates(connection, after, faults) if connection else []

    def hypotheses(self, update_id: int) -> Posterior | None:
        """The best places of an update's belief and the virtual place; None where it had none."""
        with self._deck(f"reading the hypotheses of update {update_id}") as connection:
            return update_rows.read_belief(connection, update_id) if connection else None

    def beliefs(self, after: int = 0) -> dict[int, Posterior]:
        """The same of every update after a node that had a belief, by the update's id."""
        with self._deck("reading the hypotheses") as connection:
            return update_rows.read_beliefs(connection, after) if connection else {}

    def candidates(self, after: int = 0, faults: Faults | None = None) -> list[CandidateRow]:
        """The loop closures that were looked at, after a candidate's number, ascending."""
        with self._deck("reading the candidates") as connection:
            return read_candidates(connection, after, faults) if connection else []

    def journal(self, faults: Faults | None = None) -> list[JournalEntry]:
        """People's decisions, oldest first."""
        with self._deck("reading the journal") as connection:
            return read_journal(connection, faults) if connection else []

    def poses_before(self, number: int) -> dict[int, Pose] | None:
        """T_map_base by node id before the decision whose first entry is ``number``.

        None where they are not kept (any more), or the poses of now are not those that it left.
        """
        with self._deck("reading the poses before a decision", LARGE_VALUE) as connection:
            return read_poses_before(connection, number) if connection else None

    def parameter_changes(self, faults: Faults | None = None) -> list[ParameterChange]:
        """Parameters changed while an engine ran, oldest first."""
        with self._deck("reading the parameter changes") as connection:
            return read_parameter_changes(connection, faults) if connection else []
