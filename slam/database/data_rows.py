"""Rows of the table Data: images, calibration, cloud and local grid of a node."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import Column, Connection, func, insert, select, update

from slam.camera import Camera
from slam.database.blobs import MAX_CLOUD_BYTES, NOTHING, pack_row, unpack_matrix
from slam.database.calibration import pack_camera, unpack_cameras, unpack_rig
from slam.database.encoder import ImageEncoder
from slam.database.faults import cell_size_of, number_of
from slam.database.image_size import claimed_size
from slam.database.records import NodeRecord
from slam.database.scans import StoredScan, pack_scan, unpack_scan, unpack_stored_scan
from slam.database.tables import data
from slam.errors import DatabaseError
from slam.params import Params
from slam.types import LocalGrid, Scan

_GRID = (data.c.ground_cells, data.c.obstacle_cells, data.c.empty_cells)
#: Cells are around their node.
_FARTHEST_CELL_M = 1000.0
_VIEW = (data.c.view_point_x, data.c.view_point_y, data.c.view_point_z)
_EMPTY: Mapping[str, object] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class EncodedData:
    """The blobs of a Data row, made before the transaction begins, so that it is short."""

    image: bytes | None
    depth: bytes | None
    calibration: bytes | None
    scan: bytes | None
    scan_info: bytes | None

    @classmethod
    def of(cls, record: NodeRecord, params: Params, encoder: ImageEncoder) -> EncodedData:
        """Encode images and calibration by ``Mem/ImageCompressionFormat`` and ``Mem/DepthCompressionFormat``."""
        stored = {} if record.stored is None else record.stored.data
        image = None if "image" in stored else record.image_bgr
        depth = None if "depth" in stored else record.depth_m
        scan = None if "scan" in stored else record.node.scan
        cloud, info = (None, None) if scan is None else pack_scan(scan)
        return cls(
            image=None if image is None else encoder.color(image, params.Mem.ImageCompressionFormat),
            depth=None if depth is None else encoder.depth(depth, params.Mem.DepthCompressionFormat),
            calibration=None if "calibration" in stored else pack_camera(record.node.camera),
            scan=cloud,
            scan_info=info,
        )


def insert_data(
    connection: Connection,
    node_id: int,
    encoded: EncodedData,
    grid: LocalGrid | None,
    stored: Mapping[str, object] = _EMPTY,
) -> None:
    """Add the data of a node, with the columns that it takes over; the node must be there already."""
    made = {
        "image": encoded.image,
        "depth": encoded.depth,
        "calibration": encoded.calibration,
        "scan": encoded.scan,
        "scan_info": encoded.scan_info,
    }
    values: dict[str, Any] = {"id": node_id, **stored, **{name: v for name, v in made.items() if v is not None}}
    if grid is not None:
        values |= grid_columns(grid)
    connection.execute(insert(data).values(values))


def grid_columns(grid: LocalGrid) -> dict[str, Any]:
    """The columns of a Data row that hold a local grid."""
    return {
        "ground_cells": pack_row(grid.ground.astype(np.float32)),
        "obstacle_cells": pack_row(grid.obstacles.astype(np.float32)),
        "empty_cells": pack_row(grid.empty.astype(np.float32)),
        "cell_size": grid.cell_size,
        **{column.name: value for column, value in zip(_VIEW, grid.view_point, strict=True)},
    }


def update_images(connection: Connection, node_id: int, columns: Mapping[str, object]) -> None:
    """Give a node the images among some columns."""
    images = {name: columns[name] for name in ("image", "depth") if name in columns}
    if images:
        connection.execute(update(data).where(data.c.id == node_id).values(images))


def read_image(connection: Connection, node_id: int) -> bytes:
    """The colour image as stored; DatabaseError when the node has none."""
    return _present(_blob(connection, node_id, data.c.image), node_id, "image")


def read_depth(connection: Connection, node_id: int) -> bytes:
    """The depth image as stored; DatabaseError when the node has none."""
    return _present(_blob(connection, node_id, data.c.depth), node_id, "depth image")


def read_cameras(connection: Connection, node_id: int) -> tuple[Camera, ...]:
    """The cameras of a node; DatabaseError when the node has none."""
    cameras = unpack_cameras(_present(_blob(connection, node_id, data.c.calibration), node_id, "calibration"))
    return _sized(connection, node_id, cameras)


def read_baselines(connection: Connection, node_id: int) -> tuple[float, ...]:
    """Baseline in metres of each stereo pair of a node; none for one whose depth was measured, or without a camera."""
    blob = _blob(connection, node_id, data.c.calibration)
    rig = unpack_rig(blob) if blob is not None and len(blob) > NOTHING else ()
    return tuple(baseline for _, baseline in rig if baseline is not None)


def read_scan(connection: Connection, node_id: int) -> Scan | None:
    """The cloud of a node; None when it has none."""
    row = connection.execute(select(data.c.scan, data.c.scan_info).where(data.c.id == node_id)).first()
    return None if row is None else unpack_scan(row.scan, row.scan_info)


def read_stored_scan(connection: Connection, node_id: int) -> StoredScan | None:
    """The same with all that is stored of it."""
    row = connection.execute(select(data.c.scan, data.c.scan_info).where(data.c.id == node_id)).first()
    return None if row is None else unpack_stored_scan(row.scan, row.scan_info)


def read_first_cameras(connection: Connection) -> dict[int, Camera]:
    """Node id -> its first camera, of all nodes that have one; equal ones are one object."""
    query = select(data.c.id, data.c.calibration).where(func.length(data.c.calibration) > NOTHING)
    made: dict[bytes, Camera] = {}
    found = {}
    for node_id, blob in connection.execute(query.order_by(data.c.id)):
        if blob not in made:
            made[blob] = _sized(connection, node_id, unpack_cameras(blob))[0]
        found[node_id] = made[blob]
    return found


def read_local_grid(connection: Connection, node_id: int) -> LocalGrid | None:
    """The local grid of a node, its cells flattened to (N, 2); None when it has none."""
    row = connection.execute(select(data.c.cell_size, *_VIEW, *_GRID).where(data.c.id == node_id)).first()
    if row is None or not row.cell_size:
        return None
    cell_size = cell_size_of(row.cell_size, "cell_size")
    x, y, z = (number_of(value, column.name) for value, column in zip(row[1:4], _VIEW, strict=True))
    ground, obstacles, empty = (_cells(blob) for blob in row[4:])
    return LocalGrid(ground, obstacles, empty, cell_size, (x, y, z))


def read_first_with(connection: Connection, column: Column[bytes]) -> int | None:
    """The smallest id of the nodes whose ``column`` holds something; None when there is none."""
    query = select(data.c.id).where(func.length(column) > NOTHING).order_by(data.c.id).limit(1)
    return connection.scalar(query)


def read_ids_with(connection: Connection, column: Column[bytes]) -> NDArray[np.int32]:
    """Ascending ids of the nodes whose ``column`` holds something."""
    query = select(data.c.id).where(func.length(column) > NOTHING).order_by(data.c.id)
    return np.array(connection.scalars(query).all(), dtype=np.int32)


def read_ids_with_grid(connection: Connection) -> NDArray[np.int32]:
    """Ascending ids of the nodes that have a local grid."""
    return np.array(
        connection.scalars(select(data.c.id).where(data.c.cell_size > 0).order_by(data.c.id)).all(), np.int32
    )


def _blob(connection: Connection, node_id: int, column: Column[bytes]) -> bytes | None:
    return connection.scalar(select(column).where(data.c.id == node_id))


def _sized(connection: Connection, node_id: int, cameras: tuple[Camera, ...]) -> tuple[Camera, ...]:
    """The cameras with the size of their tile of the image, where the file is so old that it does not say."""
    if all(camera.width and camera.height for camera in cameras):
        return cameras
    width, height = claimed_size(_blob(connection, node_id, data.c.image) or b"")
    return tuple(_of_size(camera, width // len(cameras), height) for camera in cameras)


def _of_size(camera: Camera, width: int, height: int) -> Camera:
    # Until 0.7.0 only the focal length was stored: the centre is that of the image.
    centre = (camera.cx, camera.cy) if camera.cx or camera.cy else (width / 2 - 0.5, height / 2 - 0.5)
    return replace(camera, width=width, height=height, cx=centre[0], cy=centre[1])


def _present(blob: bytes | None, node_id: int, what: str) -> bytes:
    if blob is None or len(blob) <= NOTHING:
        raise DatabaseError(f"node {node_id} has no {what}")
    return blob


def _cells(blob: bytes | None) -> NDArray[np.float32]:
    matrix = unpack_matrix(blob, MAX_CLOUD_BYTES)
    if matrix is None:
        return np.zeros((0, 2), dtype=np.float32)
    if matrix.ndim != 3 or matrix.dtype != np.float32:
        raise DatabaseError(f"local grid has cells of shape {matrix.shape} and {matrix.dtype}, not x, y of float32")
    cells = np.ascontiguousarray(matrix.reshape(-1, matrix.shape[-1])[:, :2], dtype=np.float32)
    far = ~(np.abs(cells) < _FARTHEST_CELL_M)
    if far.any():
        raise DatabaseError(
            f"local grid has a cell at {cells[far][0]:g} m: no sensor sees beyond {_FARTHEST_CELL_M:g} m"
        )
    return cells
