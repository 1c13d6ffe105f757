"""The one writer of a map file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import Connection

from slam.database import admin_rows, node_record, pose_rows, session_rows, time_enter
from slam.database.connection import close_plainly, open_for_writing
from slam.database.data_rows import EncodedData, update_images
from slam.database.decision import write_decision
from slam.database.encoder import ImageEncoder
from slam.database.file_check import check_file, check_writable_version
from slam.database.frame_rows import insert_frames
from slam.database.link_rows import insert_link
from slam.database.lock import MapLock, locked
from slam.database.new_file import create_file
from slam.database.node_record import KnownIds
from slam.database.node_rows import update_labels, update_weights
from slam.database.parameter_rows import change_parameters, insert_parameter_change
from slam.database.parameter_text import params_text
from slam.database.records import JournalEntry, NodeRecord
from slam.database.refusal import refusing
from slam.database.schema import add_deck_tables
from slam.errors import DatabaseError, ParameterError
from slam.geometry import Pose
from slam.params import Params, Value, format_value
from slam.types import Candidate, Link, OccupancyGrid, TrackedFrame

#: Of many decisions that are made together so many are named.
_NAMED = 5


class MapWriter:
    """Writes one map file and keeps everybody else from writing it.

    Every method is one transaction: it is in the file as a whole or, when it raises or the process dies, not at all.
    While it is open the file has a write-ahead log beside it; ``close`` makes it one plain file again. A file whose
    writer was killed is healed by the next one that opens it.
    """

    def __init__(self, path: Path, lock: MapLock) -> None:
        self.path = path
        self._lock = lock
        self._map_id: int | None = None
        self._params = Params()
        self._encoder = ImageEncoder()
        self._memory_stamp = ""
        with refusing(path, "opening for writing"):
            self._connection = open_for_writing(path, _check_version)
            with ExitStack() as undo:
                undo.callback(self._connection.close)
                self._known = _prepare(self._connection)
                undo.pop_all()

    @classmethod
    def create(cls, path: Path, params: Params, *, seed: int, source: str) -> MapWriter:
        """Make a new map file and begin its first session.

        Raises:
            DatabaseError: the file exists, or can't be made there.
            MapBusyError: another writer holds this name.
        """
        if not path.parent.is_dir():
            raise DatabaseError(f"{path} can't be made: the folder {path.parent} does not exist")
        with locked(path) as lock:
            create_file(path)
            writer = cls(path, lock)
            writer.start_session(params, seed=seed, source=source)
            return writer

    @classmethod
    def open(cls, path: Path) -> MapWriter:
        """Open an existing map, for decisions or a new session; a killed one is healed.

        Raises:
            DatabaseError: it is no map, or can't be written.
            MapBusyError: another writer holds it.
        """
        check_file(path)
        with locked(path) as lock:
            return cls(path, lock)

    @property
    def map_id(self) -> int:
        """Number of the session that runs; DatabaseError when none does."""
        if self._map_id is None:
            raise DatabaseError(f"{self.path}: no session runs: start one before nodes or frames are added")
        return self._map_id

    def start_session(self, params: Params, *, seed: int, source: str) -> int:
        """Begin a session; its map_id. One that runs is ended by it (odometry that began anew)."""
        text = params_text(params)
        with self._transaction("starting a session") as connection:
            if self._map_id is None:
                self._memory_stamp = time_enter.begin_memory(connection, text)
            session_rows.end_sessions(connection, clean=True)
            admin_rows.forget_dictionary_index(connection)
            map_id = session_rows.insert_session(connection, text, seed, source)
        self._params, self._map_id = params, map_id
        return map_id

    def expect_images(self, image_bgr: NDArray[np.uint8], depth_m: NDArray[np.float32]) -> None:
        """Tells which images the next node will have, so that another thread encodes them until then."""
        self._encoder.begin(image_bgr, depth_m, self._params)

    def add_node(self, record: NodeRecord) -> None:
        """Add a node with its data and everything that its update changed.

        Raises:
            DatabaseError: the record does not fit the map (ids, links, words), or can't be written.
        """
        doing = f"adding node {record.node.id}"
        with refusing(self.path, doing):
            self._known.check(record, self.map_id)
            encoded = EncodedData.of(record, self._params, self._encoder)
        with self._transaction(doing) as connection:
            node_record.insert_record(connection, record, encoded, self._memory_stamp)
        self._known.add(record)

    def add_frames(self, frames: Iterable[TrackedFrame]) -> None:
        """Add tracked frames that no node follows any more (at the end of a session)."""
        map_id = self.map_id
        with self._transaction("adding frames") as connection:
            insert_frames(connection, map_id, frames)

    def update_nodes(self, weights: Mapping[int, int]) -> None:
        """Change weights of nodes."""
        with self._transaction("changing weights") as connection:
            update_weights(connection, weights)

    def add_links(self, links: Iterable[Link]) -> None:
        """Add links; DatabaseError where a node does not exist or there is a link already."""
        with self._transaction("adding links") as connection:
            for link in links:
                self._known.check_link(link)
                insert_link(connection, link)

    def add_images(self, images: Iterable[tuple[int, Mapping[str, object]]]) -> None:
        """Give nodes their colour and depth images, as they are stored in another file."""
        with self._transaction("adding images") as connection:
            for node_id, columns in images:
                update_images(connection, node_id, columns)

    def change_parameters(self, changes: Mapping[str, Value]) -> None:
        """Give a finished map other parameters, with which its next session starts; each change is logged.

        Raises:
            ParameterError: none is named, or one is unknown or out of bounds.
            DatabaseError: the file has no parameters, as no session was ever saved.
        """
        if not changes:
            raise ParameterError("no parameter is named: give at least one name with its new value")
        params = Params().changed(changes)
        texts = {name: format_value(params.get(name)) for name in changes}
        with self._transaction("changing parameters") as connection:
            change_parameters(connection, texts)

    def label_nodes(self, labels: Mapping[int, str]) -> None:
        """Give nodes labels; DatabaseError where a node does not exist or another one has the label."""
        with self._transaction("labelling nodes") as connection:
            update_labels(connection, labels)

    def save_poses(self, poses_map_base: Mapping[int, Pose], last: Pose | None) -> None:
        """Replace the optimised poses T_map_base; ``last`` is the robot's own, None leaves the one that is stored."""
        with self._transaction("saving poses") as connection:
            pose_rows.replace_poses(connection, poses_map_base, last)

    def save_last_pose(self, T_map_base: Pose) -> None:
        """Replace the pose at which the robot was last."""
        with self._transaction("saving the last pose") as connection:
            pose_rows.add_poses(connection, {}, T_map_base)

    def save_grid(self, grid: OccupancyGrid | None) -> None:
        """Replace the global grid; None removes it."""
        with self._transaction("saving the grid") as connection:
            admin_rows.write_grid(connection, grid)

    def append_decision(
        self,
        entry: JournalEntry,
        *,
        add: Sequence[Link] = (),
        remove: Sequence[tuple[int, int]] = (),
        poses: Mapping[int, Pose],
    ) -> int:
        """Write a decision: journal, links and optimised poses; what was made from the old graph is removed.

        Returns:
            The number of the journal's entry.

        Raises:
            DatabaseError: a link to remove is not there, or one to add is, or nothing is left to take back.
        """
        return self.append_decisions([entry], add=add, remove=remove, poses=poses)[0]

    def append_decisions(
        self,
        entries: Sequence[JournalEntry],
        *,
        add: Sequence[Link] = (),
        remove: Sequence[tuple[int, int]] = (),
        poses: Mapping[int, Pose],
        candidates: Sequence[Candidate] = (),
    ) -> list[int]:
        """The same for decisions that are made, and taken back, together; all of them are written or none.

        ``candidates`` are loops that were looked at for them.
        """
        named = ", ".join(f"{entry.from_id}-{entry.to_id}" for entry in entries[:_NAMED])
        more = f" and {len(entries) - _NAMED} more" if len(entries) > _NAMED else ""
        with self._transaction(f"deciding about link {named}{more}") as connection:
            running = self._map_id is not None
            numbers = write_decision(
                connection, self._known, entries, add, remove, poses, candidates, in_session=running
            )
        settings = {entry.setting.name: entry.setting.after for entry in entries if entry.setting is not None}
        self._params = self._params.changed(settings) if running else self._params
        return numbers

    def parameter_change(self, node_id: int, name: str, value: Value) -> None:
        """Log that a parameter has another value from node ``node_id`` on.

        Raises:
            ParameterError: there is no such parameter, or the value is not allowed.
        """
        params = self._params.changed({name: value})
        with self._transaction(f"logging {name}") as connection:
            insert_parameter_change(connection, node_id, name, format_value(params.get(name)))
        self._params = params

    def close_session(
        self, *, ram_ids: Iterable[int], ram_word_ids: Iterable[int], params: Params, clean: bool = True
    ) -> None:
        """End the session; these nodes and words are what RTAB-Map will load into working memory."""
        text = params_text(params)
        with self._transaction("closing the session") as connection:
            time_enter.end_memory(connection, text, ram_ids, ram_word_ids)
            session_rows.end_sessions(connection, clean=clean)
            pose_rows.merge_poses(connection)
        self._map_id = None

    def close(self) -> None:
        """Make one plain file of it again and let others write it; does nothing the second time.

        Raises:
            DatabaseError: the log can't be merged now (a full disk, a reader that stays); nothing is lost by it.
        """
        if self._connection.closed:
            return
        self._encoder.close()
        try:
            with refusing(self.path, "closing"):
                close_plainly(self._connection)
        finally:
            self._lock.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @contextmanager
    def _transaction(self, doing: str) -> Iterator[Connection]:
        if self._connection.closed:
            raise DatabaseError(f"{self.path} is closed: {doing} is not possible any more")
        with refusing(self.path, doing), self._connection.begin():
            yield self._connection


def _check_version(connection: Connection) -> None:
    check_writable_version(admin_rows.read_version(connection))


def _prepare(connection: Connection) -> KnownIds:
    with connection.begin():
        add_deck_tables(connection)
        session_rows.heal_sessions(connection)
        pose_rows.merge_poses(connection)
        return KnownIds.read(connection)
