"""Rows of the table Data: images, calibration, cloud and local grid of a node."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import Column, Connection, func, insert, select

from slam.camera import Camera
from slam.database.blobs import pack_row, unpack_matrix
from slam.database.calibration import pack_camera, unpack_cameras
from slam.database.encoder import ImageEncoder
from slam.database.records import NodeRecord
from slam.database.scans import pack_scan, unpack_scan
from slam.database.tables import data
from slam.errors import DatabaseError
from slam.params import Params
from slam.types import LocalGrid, Scan

_GRID = (data.c.ground_cells, data.c.obstacle_cells, data.c.empty_cells)
_VIEW = (data.c.view_point_x, data.c.view_point_y, data.c.view_point_z)
_NOTHING = 4


@dataclass(frozen=True, slots=True)
class EncodedData:
    """The blobs of a Data row, made before the transaction begins, so that it is short."""

    image: bytes | None
    depth: bytes | None
    calibration: bytes
    scan: bytes | None
    scan_info: bytes | None

    @classmethod
    def of(cls, record: NodeRecord, params: Params, encoder: ImageEncoder) -> EncodedData:
        """Encode images and calibration by ``Mem/ImageCompressionFormat`` and ``Mem/DepthCompressionFormat``."""
        image, depth = record.image_bgr, record.depth_m
        scan, info = (None, None) if record.node.scan is None else pack_scan(record.node.scan)
        return cls(
            image=None if image is None else encoder.color(image, params.Mem.ImageCompressionFormat),
            depth=None if depth is None else encoder.depth(depth, params.Mem.DepthCompressionFormat),
            calibration=pack_camera(record.node.camera),
            scan=scan,
            scan_info=info,
        )


def insert_data(connection: Connection, node_id: int, encoded: EncodedData, grid: LocalGrid | None) -> None:
    """Add the data of a node; the node must be there already."""
    values: dict[str, Any] = {
        "id": node_id,
        "image": encoded.image,
        "depth": encoded.depth,
        "calibration": encoded.calibration,
        "scan": encoded.scan,
        "scan_info": encoded.scan_info,
    }
    if grid is not None:
        values |= {
            "ground_cells": pack_row(grid.ground.astype(np.float32)),
            "obstacle_cells": pack_row(grid.obstacles.astype(np.float32)),
            "empty_cells": pack_row(grid.empty.astype(np.float32)),
            "cell_size": grid.cell_size,
            **{column.name: value for column, value in zip(_VIEW, grid.view_point, strict=True)},
        }
    connection.execute(insert(data).values(values))


def read_image(connection: Connection, node_id: int) -> bytes:
    """The colour image as stored; DatabaseError when the node has none."""
    return _present(_blob(connection, node_id, data.c.image), node_id, "image")


def read_depth(connection: Connection, node_id: int) -> bytes:
    """The depth image as stored; DatabaseError when the node has none."""
    return _present(_blob(connection, node_id, data.c.depth), node_id, "depth image")


def read_cameras(connection: Connection, node_id: int) -> tuple[Camera, ...]:
    """The cameras of a node; DatabaseError when the node has none."""
    return unpack_cameras(_present(_blob(connection, node_id, data.c.calibration), node_id, "calibration"))


def read_scan(connection: Connection, node_id: int) -> Scan | None:
    """The cloud of a node; None when it has none."""
    row = connection.execute(select(data.c.scan, data.c.scan_info).where(data.c.id == node_id)).first()
    return None if row is None else unpack_scan(row.scan, row.scan_info)


def read_first_cameras(connection: Connection) -> dict[int, Camera]:
    """Node id -> its first camera, of all nodes that have one; equal ones are one object."""
    query = select(data.c.id, data.c.calibration).where(func.length(data.c.calibration) > _NOTHING)
    made: dict[bytes, Camera] = {}
    found = {}
    for node_id, blob in connection.execute(query.order_by(data.c.id)):
        if blob not in made:
            made[blob] = unpack_cameras(blob)[0]
        found[node_id] = made[blob]
    return found


def read_local_grid(connection: Connection, node_id: int) -> LocalGrid | None:
    """The local grid of a node, its cells flattened to (N, 2); None when it has none."""
    row = connection.execute(select(data.c.cell_size, *_VIEW, *_GRID).where(data.c.id == node_id)).first()
    if row is None or not row.cell_size:
        return None
    x, y, z = (float(v or 0.0) for v in row[1:4])
    ground, obstacles, empty = (_cells(blob) for blob in row[4:])
    return LocalGrid(ground, obstacles, empty, float(row.cell_size), (x, y, z))


def read_ids_with(connection: Connection, column: Column[bytes]) -> NDArray[np.int32]:
    """Ascending ids of the nodes whose ``column`` holds something."""
    query = select(data.c.id).where(column.is_not(None)).order_by(data.c.id)
    return np.array(connection.scalars(query).all(), dtype=np.int32)


def _blob(connection: Connection, node_id: int, column: Column[bytes]) -> bytes | None:
    return connection.scalar(select(column).where(data.c.id == node_id))


def _present(blob: bytes | None, node_id: int, what: str) -> bytes:
    if blob is None or len(blob) <= _NOTHING:
        raise DatabaseError(f"node {node_id} has no {what}")
    return blob


def _cells(blob: bytes | None) -> NDArray[np.float32]:
    matrix = unpack_matrix(blob)
    if matrix is None:
        return np.zeros((0, 2), dtype=np.float32)
    return np.ascontiguousarray(matrix.reshape(-1, matrix.shape[-1])[:, :2], dtype=np.float32)
