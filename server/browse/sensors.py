"""What a node has besides images and key points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import TypeVar

import numpy as np

from server.schemas import CloudFacts, GpsFix, GridFacts, NodeSensors, SensorReading, UserData, Vector
from slam.database import MapReader
from slam.database.sensor_values import NodeSensors as StoredSensors
from slam.errors import DatabaseError
from slam.types import LocalGrid, Scan

T = TypeVar("T")


def node_sensors(reader: MapReader, node_id: int) -> NodeSensors:
    """GPS, readings, user data and the like of a node, and the size of its scan and local grid.

    What is damaged is told of as a problem: the rest of the node can be looked at all the same.
    """
    problems: list[str] = []
    stored = _readable(problems, reader.sensors, node_id) or StoredSensors()
    return NodeSensors(
        velocity=None if stored.velocity is None else stored.velocity.tolist(),
        gps=None if stored.gps is None else GpsFix(**asdict(stored.gps)),
        readings=[
            SensorReading(name=one.name, unit=one.unit, value=one.value, stamp=one.stamp) for one in stored.environment
        ],
        vectors=[Vector(type=one.kind, size=len(one.values)) for one in stored.descriptors],
        user_data=_user_data(stored),
        scan=_scan(_readable(problems, reader.scan, node_id)),
        grid=_grid(_readable(problems, reader.local_grid, node_id)),
        problems=problems,
    )


def _user_data(stored: StoredSensors) -> UserData | None:
    matrix = stored.user_data
    if matrix is None:
        return None
    rows, columns = matrix.shape[:2]
    return UserData(rows=rows, columns=columns, type=matrix.dtype.name, text=stored.user_text)


def _readable(problems: list[str], read: Callable[[int], T], node_id: int) -> T | None:
    try:
        return read(node_id)
    except DatabaseError as error:
        problems.append(str(error))
        return None


def _scan(scan: Scan | None) -> CloudFacts | None:
    if scan is None:
        return None
    farthest = float(np.linalg.norm(scan.points_base, axis=1).max(initial=0.0))
    return CloudFacts(points=len(scan), normals=scan.normals_base is not None, range_m=farthest)


def _grid(grid: LocalGrid | None) -> GridFacts | None:
    if grid is None:
        return None
    return GridFacts(
        ground=len(grid.ground), obstacles=len(grid.obstacles), empty=len(grid.empty), cell_size_m=grid.cell_size
    )
