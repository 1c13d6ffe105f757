"""The cloud and the mesh that were put together of the whole map, and the picture of it, in the table Admin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import Column, Connection, select

from slam.database.blobs import unpack_matrix
from slam.database.tables import admin
from slam.errors import DatabaseError

#: Channels of a cloud -> whether it has a z, and whether the fourth is the colour.
_CHANNELS = {2: (False, False), 3: (True, False), 4: (True, True), 5: (False, False), 6: (True, False), 7: (True, True)}
_CORNERS = 3


@dataclass(frozen=True, slots=True, eq=False)
class Cloud:
    """Points (N, 3) float32 in the map frame, metres, and colours (N, 3) uint8, red first, if any."""

    points: NDArray[np.float32]
    colours: NDArray[np.uint8] | None


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """The part of a mesh with one texture.

    Attributes:
        triangles: (T, 3) int32 rows of the mesh's points; polygons with more corners are cut into triangles.
        corners: (T, 3, 2) float32 places in the texture, 0 to 1; None without one.
    """

    triangles: NDArray[np.int32]
    corners: NDArray[np.float32] | None


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """The mesh of a map: its points, its parts, and their textures side by side as a JPEG or PNG (None without)."""

    cloud: Cloud
    parts: tuple[Part, ...]
    textures: bytes | None


def read_preview(connection: Connection) -> bytes | None:
    """The stored picture of the map as it is (JPEG or PNG); None where there is none."""
    return _blob(connection, admin.c.preview_image)


def read_cloud(connection: Connection) -> Cloud | None:
    """The assembled cloud; None where none is stored.

    Raises:
        DatabaseError: it has channels that no cloud of RTAB-Map has.
    """
    matrix = unpack_matrix(_blob(connection, admin.c.opt_cloud))
    if matrix is None:
        return None
    rows = matrix.reshape(-1, matrix.shape[2] if matrix.ndim == 3 else 1).astype(np.float32)
    if rows.shape[1] not in _CHANNELS:
        raise DatabaseError(f"the stored cloud has {rows.shape[1]} channels: clouds of RTAB-Map have 2 to 7")
    solid, coloured = _CHANNELS[rows.shape[1]]
    points = rows[:, :3].copy() if solid else np.column_stack([rows[:, :2], np.zeros(len(rows), np.float32)])
    return Cloud(points, packed_colours(rows[:, 3]) if coloured else None)


def read_mesh(connection: Connection) -> Mesh | None:
    """The mesh; None where none is stored.

    Raises:
        DatabaseError: its polygons refer to points, or its textures to corners, that are not there.
    """
    cloud, polygons = read_cloud(connection), unpack_matrix(_blob(connection, admin.c.opt_polygons))
    if cloud is None or polygons is None:
        return None
    size = connection.scalar(select(admin.c.opt_polygons_size)) or 0
    coordinates = unpack_matrix(_blob(connection, admin.c.opt_tex_coords))
    parts = _polygons(polygons.ravel().astype(np.int64), size, len(cloud.points))
    placed = [None] * len(parts) if coordinates is None else _corners(coordinates.ravel().astype(np.float32))
    if len(placed) != len(parts):
        raise DatabaseError(f"the mesh has {len(parts)} materials and texture coordinates of {len(placed)}")
    made = (_part(part, corners) for part, corners in zip(parts, placed, strict=True))
    return Mesh(cloud, tuple(made), _blob(connection, admin.c.opt_tex_materials))


def packed_colours(channel: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Colours (N, 3), red green blue, of floats whose bits are blue, green and red from the lowest byte on."""
    return np.ascontiguousarray(channel).view(np.uint8).reshape(-1, 4)[:, 2::-1].copy()


def _polygons(numbers: NDArray[np.int64], size: int, points: int) -> list[NDArray[np.int64]]:
    """Polygons (P, size) of each material: a count, then as many times ``size`` rows of points."""
    if size < _CORNERS:
        raise DatabaseError(f"polygons of the mesh have {size} corners: 3 or more are needed")
    found, at = [], 0
    while at < len(numbers):
        count = int(numbers[at])
        part = numbers[at + 1 : at + 1 + count * size]
        if count < 0 or len(part) != count * size or (count and not 0 <= part.min() <= part.max() < points):
            raise DatabaseError(f"the mesh's polygons are damaged: {count} of {size} corners among {points} points")
        found.append(part.reshape(-1, size))
        at += 1 + len(part)
    return found


def _corners(numbers: NDArray[np.float32]) -> list[NDArray[np.float32]]:
    """Texture coordinates (C, 2) of each material: a count, then as many pairs."""
    found, at = [], 0
    while at < len(numbers):
        count = int(numbers[at]) if np.isfinite(numbers[at]) else -1
        part = numbers[at + 1 : at + 1 + 2 * count]
        if count < 0 or len(part) != 2 * count:
            raise DatabaseError(f"the mesh's texture coordinates are damaged: {len(part)} numbers for {count} corners")
        found.append(part.reshape(-1, 2))
        at += 1 + len(part)
    return found


def _part(polygons: NDArray[np.int64], corners: NDArray[np.float32] | None) -> Part:
    """A fan of triangles for each polygon, with the corners of the texture in the order of the polygons' corners."""
    count, size = polygons.shape
    fan = np.array([(0, i, i + 1) for i in range(1, size - 1)])
    triangles = polygons[:, fan].reshape(-1, _CORNERS).astype(np.int32)
    if corners is None or len(corners) != count * size:
        return Part(triangles, None)
    return Part(triangles, corners.reshape(count, size, 2)[:, fan].reshape(-1, _CORNERS, 2))


def _blob(connection: Connection, column: Column[bytes]) -> bytes | None:
    return connection.scalar(select(column))
