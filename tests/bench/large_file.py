"""A map file of many nodes and great size that takes little of the disk.

Images are zeros on pages of 64 kB, and the zeros are punched out of the file: 20 GB of file take some 2 GB of disk.
"""

from __future__ import annotations

import sqlite3
import subprocess
from contextlib import closing
from pathlib import Path

import numpy as np
from sqlalchemy import StaticPool, create_engine

from slam.camera import Camera
from slam.database.blobs import pack_information, pack_matrix, pack_transform, pack_transforms
from slam.database.calibration import pack_camera
from slam.database.schema import create_schema
from slam.database.statistics_text import pack_statistics
from slam.geometry import Pose, between, make, so3_exp
from slam.types import LinkType

#: Bytes of an image and of its depth: two millions together, as a camera of 1280x960 gives.
_IMAGE, _DEPTH = 1_500_000, 500_000
_PAGE = 65_536
_FEATURES, _WORDS, _STATISTICS = 500, 50, 150
_NODES_OF_A_LAP, _LOOP_EVERY = 400, 10
#: Nodes between two looks for zeros.
_PART = 250
_ADD_DATA = "INSERT INTO Data(id, image, depth, calibration) VALUES (?, zeroblob(?), zeroblob(?), ?)"
_ADD_FEATURES = (
    "WITH RECURSIVE k(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM k WHERE i < ?) INSERT INTO Feature"
    " SELECT ?, i, 1.5 * i, i, 31, 0.0, 0.5, 0, 1.0, 2.0, 3.0, 32, randomblob(32) FROM k"
)
_ADD_WORDS = (
    "WITH RECURSIVE k(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM k WHERE i < ?) INSERT INTO"
    " Word(id, descriptor_size, descriptor) SELECT ? + i, 32, randomblob(32) FROM k"
)


def write_large_file(path: Path, nodes: int) -> None:
    """A map of laps with a loop at each tenth node, 500 key points and two million bytes of images for each node."""
    with closing(sqlite3.connect(path, isolation_level=None)) as connection:
        for pragma in (f"page_size = {_PAGE}", "journal_mode = OFF", "synchronous = OFF"):
            connection.execute(f"PRAGMA {pragma}")
        # The size of a page holds for the connection that was told it.
        with create_engine("sqlite://", creator=lambda: connection, poolclass=StaticPool).connect() as schema:
            create_schema(schema)
        connection.execute("DROP TRIGGER insert_Data_timeEnter")
        punched = 0
        for first in range(1, nodes + 1, _PART):
            connection.execute("BEGIN")
            _add_nodes(connection, range(first, min(first + _PART, nodes + 1)))
            connection.execute("COMMIT")
            size = path.stat().st_size
            subprocess.run(["fallocate", "-d", "-o", str(punched), "-l", str(size - punched), str(path)], check=True)
            punched = size
        _finish(connection, nodes)


def _pose(node_id: int) -> Pose:
    angle = 2 * np.pi * node_id / _NODES_OF_A_LAP
    return make(so3_exp(np.array([0.0, 0.0, angle])), np.array([10 * np.cos(angle), 10 * np.sin(angle), 0.0]))


def _add_nodes(connection: sqlite3.Connection, ids: range) -> None:
    calibration = pack_camera(Camera(1280, 960, 900.0, 900.0, 639.5, 479.5))
    statistics = pack_statistics({f"Group/Name_of_{i}/ms": 1.0 / (i + 1) for i in range(_STATISTICS)})
    poses = [(i, 0, 0, float(i), pack_transform(_pose(i))) for i in ids]
    connection.executemany("INSERT INTO Node(id, map_id, weight, stamp, pose) VALUES (?, ?, ?, ?, ?)", poses)
    connection.executemany(_ADD_DATA, [(i, _IMAGE, _DEPTH, calibration) for i in ids])
    connection.executemany(_ADD_FEATURES, [(_FEATURES, i) for i in ids])
    connection.executemany(_ADD_WORDS, [(_WORDS, _WORDS * i) for i in ids])
    connection.executemany(
        "INSERT INTO Statistics(id, stamp, data) VALUES (?, ?, ?)", [(i, i, statistics) for i in ids]
    )
    rows = [row for i in ids for row in _links(i)]
    connection.executemany(
        "INSERT INTO Link(from_id, to_id, type, information_matrix, transform) VALUES (?, ?, ?, ?, ?)", rows
    )


def _links(node_id: int) -> list[tuple[int, int, int, bytes, bytes]]:
    older = [(node_id - 1, LinkType.NEIGHBOR)]
    if node_id % _LOOP_EVERY == 0:
        older.append((node_id - _NODES_OF_A_LAP, LinkType.GLOBAL_CLOSURE))
    information = pack_information(100.0 * np.eye(6))
    return [
        (a, b, int(kind), information, pack_transform(between(_pose(a), _pose(b))))
        for other, kind in older
        if other > 0
        for a, b in ((node_id, other), (other, node_id))
    ]


def _finish(connection: sqlite3.Connection, nodes: int) -> None:
    ids = np.arange(1, nodes + 1, dtype=np.int32)[np.newaxis]
    poses = pack_transforms([_pose(i) for i in range(1, nodes + 1)])
    connection.execute("UPDATE Admin SET opt_ids = ?, opt_poses = ?", (pack_matrix(ids), pack_matrix(poses)))
    connection.execute(
        "INSERT INTO Info(STM_size, last_sign_added, parameters) VALUES (?, ?, ?)", (10, nodes, "Mem/STMSize:10")
    )
