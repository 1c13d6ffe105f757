"""Velocity, GPS, environmental sensors, global descriptors and user data of a node."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import Connection, select

from slam.database.blobs import NOTHING, unpack_matrix
from slam.database.sensor_values import EnvironmentValue, GlobalDescriptor, Gps, NodeSensors
from slam.database.tables import data, global_descriptor, link, node
from slam.errors import DatabaseError
from slam.types import LinkType

_VELOCITY, _GPS, _ENVIRONMENT = 6, 6, 3


def read_sensors(connection: Connection, node_id: int) -> NodeSensors:
    """What a node has of these.

    Raises:
        DatabaseError: the node is not in the map, or a blob has another size than its kind.
    """
    query = select(node.c.velocity, node.c.gps, node.c.env_sensors, data.c.user_data)
    row = connection.execute(query.outerjoin(data, data.c.id == node.c.id).where(node.c.id == node_id)).first()
    if row is None:
        raise DatabaseError(f"node {node_id} is not in the map")
    velocity, gps = _numbers(row.velocity, "<f4", _VELOCITY), _numbers(row.gps, "<f8", _GPS)
    readings = _numbers(row.env_sensors, "<f8", _ENVIRONMENT)
    return NodeSensors(
        velocity=velocity[0] if len(velocity) and np.isfinite(velocity).all() else None,
        gps=Gps(*gps[0].tolist()) if len(gps) else None,
        environment=tuple(EnvironmentValue(int(kind), value, stamp) for kind, value, stamp in readings.tolist()),
        descriptors=_descriptors(connection, node_id),
        user_data=unpack_matrix(row.user_data),
    )


def read_gps(connection: Connection) -> dict[int, Gps]:
    """Node id -> where on the earth it was, of all nodes that know."""
    rows = connection.execute(select(node.c.id, node.c.gps).where(node.c.gps.is_not(None)).order_by(node.c.id))
    found = ((row.id, _numbers(row.gps, "<f8", _GPS)) for row in rows)
    return {node_id: Gps(*numbers[0].tolist()) for node_id, numbers in found if len(numbers)}


def read_marker_lengths(connection: Connection) -> dict[int, float]:
    """Landmark id (negative) -> length of the marker's side in metres, where it is stored with a sighting."""
    query = select(link.c.to_id, link.c.user_data).where(
        (link.c.type == int(LinkType.LANDMARK)) & link.c.user_data.is_not(None)
    )
    sizes = ((row.to_id, unpack_matrix(row.user_data)) for row in connection.execute(query))
    return {number: float(size.ravel()[0]) for number, size in sizes if size is not None and size.size == 1}


def _descriptors(connection: Connection, node_id: int) -> tuple[GlobalDescriptor, ...]:
    query = select(global_descriptor.c.type, global_descriptor.c.data).where(global_descriptor.c.node_id == node_id)
    found = ((row.type, unpack_matrix(row.data)) for row in connection.execute(query))
    return tuple(GlobalDescriptor(kind, values.ravel()) for kind, values in found if values is not None)


def _numbers(blob: bytes | None, kind: str, width: int) -> NDArray[np.floating]:
    """Rows of ``width`` numbers, none for NULL."""
    if blob is None or len(blob) <= NOTHING:
        return np.zeros((0, width))
    size = np.dtype(kind).itemsize * width
    if len(blob) % size:
        raise DatabaseError(f"a blob of {len(blob)} bytes holds no rows of {width} numbers ({size} bytes each)")
    return np.frombuffer(blob, dtype=kind).reshape(-1, width)
