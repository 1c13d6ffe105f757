"""Writing a whole node record, after a look at whether it fits the map."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from sqlalchemy import Connection

from slam.database.admin_rows import write_grid
from slam.database.candidate_rows import insert_candidates
from slam.database.data_rows import EncodedData, insert_data
from slam.database.feature_rows import insert_features, rename_words
from slam.database.frame_rows import insert_frames
from slam.database.link_rows import insert_link, merged_marker, remove_link
from slam.database.node_rows import first_label, insert_node, read_node_ids, update_weights
from slam.database.pose_rows import add_poses
from slam.database.records import NodeRecord
from slam.database.reduction_rows import write_reduction
from slam.database.statistics_rows import insert_statistics
from slam.database.time_enter import keep_in_memory, now_text
from slam.database.update_rows import insert_update
from slam.database.word_rows import insert_words, read_word_ids
from slam.errors import DatabaseError
from slam.types import WEIGHT_INVALID, Link


@dataclass(frozen=True, slots=True, eq=False)
class KnownIds:
    """The nodes and words that are in the file."""

    nodes: set[int]
    words: set[int]

    @classmethod
    def read(cls, connection: Connection) -> Self:
        """Those of a map file."""
        return cls(read_node_ids(connection), read_word_ids(connection))

    def check(self, record: NodeRecord, map_id: int) -> None:
        """Refuse a record that RTAB-Map could not load, or of another session than ``map_id``.

        Raises:
            DatabaseError: an id is taken or not positive, or a link or key point refers to what does not exist.
        """
        node_id = record.node.id
        if record.node.map_id != map_id:
            raise DatabaseError(f"node {node_id} belongs to session {record.node.map_id}, and session {map_id} runs")
        if node_id <= 0 or node_id in self.nodes:
            raise DatabaseError(
                f"node {node_id} can't be added: ids are positive and used once (the map has {len(self.nodes)} nodes)"
            )
        new_words = {int(i) for i in record.words.ids}
        if len(new_words) < len(record.words) or new_words & self.words or min(new_words, default=1) <= 0:
            raise DatabaseError(
                f"new words of node {node_id} can't be added: their ids must be positive and not used yet"
            )
        missing = {int(i) for i in np.unique(record.node.word_ids) if i > 0} - self.words - new_words
        # A dropped node is never loaded; RTAB-Map too forgets the words that it alone had.
        if missing and record.node.weight != WEIGHT_INVALID:
            raise DatabaseError(
                f"node {node_id} refers to {len(missing)} words that are not in the dictionary, first {min(missing)}"
            )
        unknown = {new for words in record.renamed_words.values() for new in words.values()} - self.words - new_words
        if unknown:
            raise DatabaseError(
                f"words of older nodes can't become {min(unknown)} with node {node_id}: it is not in the dictionary"
            )
        for link in (*record.links, *(new for reduction in record.reductions for new in reduction.links)):
            self.check_link(link, node_id)

    def check_link(self, link: Link, new_id: int = 0) -> None:
        """Refuse a link of a node that does not exist."""
        for node_id in (link.from_id, link.to_id):
            if node_id > 0 and node_id != new_id and node_id not in self.nodes:
                raise DatabaseError(
                    f"link {link.from_id}-{link.to_id} can't be stored: node {node_id} is not in the map"
                )

    def add(self, record: NodeRecord) -> None:
        """Take in what was written."""
        self.nodes.add(record.node.id)
        self.words.update(int(i) for i in record.words.ids)


def insert_record(connection: Connection, record: NodeRecord, encoded: EncodedData, memory_stamp: str) -> None:
    """Write a node and its update; ``memory_stamp`` is the newest Info row's, which the node must not be older than."""
    node, node_id = record.node, record.node.id
    early = now_text() < memory_stamp
    of_node, of_data = ({}, {}) if record.stored is None else (record.stored.node, record.stored.data)
    insert_node(connection, node, first_label(connection, node.map_id), of_node)
    insert_data(connection, node_id, encoded, record.grid, of_data)
    insert_words(connection, record.words)
    insert_features(connection, node)
    rename_words(connection, record.renamed_words)
    if early:
        keep_in_memory(connection, memory_stamp, [node_id], record.words.ids.tolist())
    _write_links(connection, record)
    for reduction in record.reductions:
        write_reduction(connection, reduction)
    update_weights(connection, record.weights)
    insert_statistics(connection, node_id, node.stamp, record.statistics, record.wm_ids)
    insert_update(connection, node_id, record.update)
    insert_candidates(connection, node_id, record.update.candidates)
    insert_frames(connection, node.map_id, record.frames)
    if record.poses:
        add_poses(connection, record.poses, record.update.T_map_base)
    if record.grid_map is not None:
        write_grid(connection, record.grid_map)


def _write_links(connection: Connection, record: NodeRecord) -> None:
    for from_id, to_id in record.removed_links:
        remove_link(connection, from_id, to_id)
    for link in record.links:
        insert_link(connection, link)
    if record.merged_into is not None:
        insert_link(connection, merged_marker(record.node.id, record.merged_into))
