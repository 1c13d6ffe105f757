"""Reading a map file without changing a byte of it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.database import admin_rows, data_rows, mesh_rows, node_rows, pose_rows, sensor_rows, statistics_rows
from slam.database.data_reader import DataReader
from slam.database.deck_reader import DeckReader
from slam.database.faults import Faults
from slam.database.flaws import Flaws, read_flaws
from slam.database.guard import LARGE_VALUE
from slam.database.info import read_info
from slam.database.link_rows import count_one_way, read_link_user_data, read_links
from slam.database.mesh_rows import Cloud, Mesh
from slam.database.parameter_rows import read_parameters
from slam.database.records import WordRows
from slam.database.rows import MapInfo, NodeRow, NodeTable, SessionRow, StatisticsTable
from slam.database.schema import has_deck_tables
from slam.database.sensor_values import Gps
from slam.database.session_rows import read_sessions
from slam.database.tables import data
from slam.database.time_enter import read_memory_ids, read_memory_node_ids
from slam.database.word_rows import read_last_word_id, read_words
from slam.geometry import Pose
from slam.types import Link, OccupancyGrid

_KINDS = {"image": data.c.image, "depth": data.c.depth, "calibration": data.c.calibration, "scan": data.c.scan}


class MapReader(DeckReader, DataReader):
    """Reads a map file of slamdeck or of RTAB-Map 0.5 to 0.23 (of before 0.18 to look at only).

    Each call opens and closes its own connection: calls may come from any thread, each sees the last commit of a writer
    that is at work, and the file is not changed. What slamdeck alone records (updates, candidates,
    frames, decisions) is empty for files that RTAB-Map wrote. Poses are (4, 4), lengths metres, stamps seconds.

    Rows that make no sense are a DamagedRowError, or go to ``faults`` where that is given and all others are wanted.

    Raises (also every method):
        DatabaseError: the file is missing, not a map, of a version that is not known, damaged; or a node asked for, or
            the data of it, does not exist.
    """

    def info(self, *, sizes: bool = True, faults: Faults | None = None) -> MapInfo:
        """Summary of the map; without ``sizes`` (bytes by kind) it is fast for any size of map."""
        with self._reading("reading the summary") as connection:
            return read_info(connection, self.path, deck=has_deck_tables(connection), sizes=sizes, faults=faults)

    def node_ids(self) -> NDArray[np.int32]:
        """Ascending ids of all nodes, merged and dropped ones (weight -9) included."""
        with self._reading("reading the nodes") as connection:
            return np.array(sorted(node_rows.read_node_ids(connection)), dtype=np.int32)

    def nodes_with(self, kind: Literal["image", "depth", "calibration", "scan"]) -> NDArray[np.int32]:
        """Ascending ids of the nodes that have data of a kind."""
        with self._reading("reading the nodes") as connection:
            return data_rows.read_ids_with(connection, _KINDS[kind])

    def nodes_with_grid(self) -> NDArray[np.int32]:
        """Ascending ids of the nodes that have a local grid."""
        with self._reading("reading the nodes") as connection:
            return data_rows.read_ids_with_grid(connection)

    def first_node_with(self, kind: Literal["image", "depth", "calibration"]) -> int | None:
        """The smallest id of a node that has data of a kind; None when there is none."""
        with self._reading("reading the nodes") as connection:
            return data_rows.read_first_with(connection, _KINDS[kind])

    def nodes(self, faults: Faults | None = None) -> NodeTable:
        """All nodes as columns; none of their data."""
        with self._reading("reading the nodes") as connection:
            return node_rows.read_nodes(connection, faults)

    def node(self, node_id: int) -> NodeRow:
        """One node in full, but for images and key points."""
        with self._reading(f"reading node {node_id}") as connection:
            return node_rows.read_node(connection, node_id)

    def word_counts(self, ids: Sequence[int]) -> dict[int, int]:
        """Number of key points that are words of the dictionary, by id, of those of these nodes that have any."""
        with self._reading("counting words") as connection:
            return node_rows.read_word_counts(connection, ids)

    def links(self, faults: Faults | None = None) -> list[Link]:
        """All links, each pair once, from the newer node to the older."""
        with self._reading("reading the links") as connection:
            return read_links(connection, faults)

    def link_user_data(self, from_id: int, to_id: int) -> NDArray[np.generic] | None:
        """The matrix that is attached to the link between two nodes; None where there is none."""
        with self._reading(f"reading link {from_id}-{to_id}") as connection:
            return read_link_user_data(connection, from_id, to_id)

    def poses(self) -> dict[int, Pose]:
        """Optimised poses T_map_base by node id; empty when none are stored."""
        with self._reading("reading the poses", LARGE_VALUE) as connection:
            return pose_rows.read_poses(connection)

    def last_pose(self) -> Pose | None:
        """Where the robot was last, T_map_base; None when it is not stored."""
        with self._reading("reading the last pose", LARGE_VALUE) as connection:
            return pose_rows.read_last(connection)

    def grid(self) -> OccupancyGrid | None:
        """The global grid; None when none is stored."""
        with self._reading("reading the grid", LARGE_VALUE) as connection:
            return admin_rows.read_grid(connection)

    def gps(self) -> dict[int, Gps]:
        """Where on the earth the nodes were, by id, of those that know."""
        with self._reading("reading the positions of GPS") as connection:
            return sensor_rows.read_gps(connection)

    def marker_lengths(self) -> dict[int, float]:
        """Landmark id (negative) -> length of the marker's side in metres, where it is stored."""
        with self._reading("reading the landmarks") as connection:
            return sensor_rows.read_marker_lengths(connection)

    def one_way_links(self) -> int:
        """Number of neighbour links without a reverse, which files have that were never closed."""
        with self._reading("reading the links") as connection:
            return count_one_way(connection)

    def cloud(self) -> Cloud | None:
        """The cloud that was assembled of the whole map; None when none is stored."""
        with self._reading("reading the cloud of the map") as connection:
            return mesh_rows.read_cloud(connection)

    def has_cloud(self) -> bool:
        """Whether a cloud of the whole map is stored, which a mesh has too."""
        with self._reading("looking for the cloud of the map") as connection:
            return mesh_rows.has_cloud(connection)

    def mesh(self) -> Mesh | None:
        """The mesh of the whole map; None when none is stored."""
        with self._reading("reading the mesh") as connection:
            return mesh_rows.read_mesh(connection)

    def preview(self) -> bytes | None:
        """The stored picture of the map (JPEG or PNG); None when there is none."""
        with self._reading("reading the picture of the map") as connection:
            return mesh_rows.read_preview(connection)

    def first_cameras(self) -> dict[int, Camera]:
        """The first camera of each node that has one."""
        with self._reading("reading the calibrations") as connection:
            return data_rows.read_first_cameras(connection)

    def words(self, ids: Sequence[int] | None = None) -> WordRows:
        """The whole dictionary, or those of these words that it has; ascending by id."""
        with self._reading("reading the dictionary") as connection:
            return read_words(connection, ids)

    def last_word_id(self) -> int:
        """The largest id of a word, 0 when there is none."""
        with self._reading("reading the dictionary") as connection:
            return read_last_word_id(connection)

    def statistics(
        self,
        ids: Collection[int] | None = None,
        names: Sequence[str] | None = None,
        *,
        after: int = 0,
        faults: Faults | None = None,
    ) -> StatisticsTable:
        """Statistics as columns: of the updates ``ids`` (all), those after a node, by ``names`` (all)."""
        with self._reading("reading the statistics") as connection:
            return statistics_rows.read_statistics(connection, ids, names, after, faults)

    def statistic_names(self) -> list[str]:
        """All names, sorted."""
        return sorted(self.statistics().values)

    def wm_states(
        self, after: int = 0, most: int | None = None, faults: Faults | None = None
    ) -> dict[int, NDArray[np.int32]]:
        """Ids in short-term and working memory at updates after a node where they were kept (the first ``most``)."""
        with self._reading("reading the working memory") as connection:
            return statistics_rows.read_wm_states(connection, after, most, faults)

    def memory_ids(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """Ascending ids of the nodes and of the words that RTAB-Map would load into working memory."""
        with self._reading("reading the working memory") as connection:
            return read_memory_ids(connection)

    def flaws(self) -> Flaws:
        """What is missing or too much in the file."""
        with self._reading("looking for flaws") as connection:
            return read_flaws(connection)

    def memory_node_ids(self) -> NDArray[np.int32]:
        """Ascending ids of the nodes alone: a map has fifty words and more for each."""
        with self._reading("reading the working memory") as connection:
            return read_memory_node_ids(connection)

    def parameters(self) -> dict[str, str]:
        """Parameters of the newest session, as text by name."""
        with self._reading("reading the parameters") as connection:
            return read_parameters(connection)

    def sessions(self, faults: Faults | None = None) -> list[SessionRow]:
        """All sessions by number."""
        with self._reading("reading the sessions") as connection:
            return read_sessions(connection, deck=has_deck_tables(connection), faults=faults)
