"""What a node has besides images and key points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from server.browse.columns import pose_list
from server.browse.plan_reach import grid_reach, scan_reach
from server.schemas import CloudFacts, GpsFix, GridFacts, NodeSensors, SensorReading, UserData, Vector
from slam.database import MapReader
from slam.database.scans import StoredScan
from slam.database.sensor_values import NodeSensors as StoredSensors
from slam.database.sensor_values import text_in
from slam.errors import DatabaseError
from slam.types import LocalGrid

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
        user_data=user_data_facts(stored.user_data),
        scan=_scan(_readable(problems, reader.stored_scan, node_id)),
        grid=None if (grid := _readable(problems, reader.local_grid, node_id)) is None else grid_facts(grid),
        problems=problems,
    )


def user_data_facts(matrix: NDArray[np.generic] | None) -> UserData | None:
    """What a program attached to a node or a link."""
    if matrix is None:
        return None
    rows, columns = matrix.shape[:2]
    return UserData(rows=rows, columns=columns, type=matrix.dtype.name, bytes=int(matrix.nbytes), text=text_in(matrix))


def _readable(problems: list[str], read: Callable[[int], T], node_id: int) -> T | None:
    try:
        return read(node_id)
    except DatabaseError as error:
        problems.append(str(error))
        return None


def _scan(stored: StoredScan | None) -> CloudFacts | None:
    if stored is None:
        return None
    scan, (first, last, step) = stored.scan, stored.angles_rad
    return CloudFacts(
        points=len(scan),
        normals=scan.normals_base is not None,
        intensities=stored.intensities is not None,
        format=stored.format,
        range_m=float(np.linalg.norm(scan.points_base, axis=1).max(initial=0.0)),
        scanner_range_m=list(stored.range_m) if stored.range_m[1] > 0 else None,
        angles_deg=np.degrees([first, last, step]).tolist() if step else None,
        most=stored.most,
        mount=pose_list(stored.T_base_scan),
        reach_m=scan_reach(scan.points_base),
    )


def grid_facts(grid: LocalGrid) -> GridFacts:
    """How many cells a local grid has, and of what size."""
    return GridFacts(
        ground=len(grid.ground),
        obstacles=len(grid.obstacles),
        empty=len(grid.empty),
        cell_size_m=grid.cell_size,
        view_point=list(grid.view_point),
        reach_m=grid_reach(grid),
    )
