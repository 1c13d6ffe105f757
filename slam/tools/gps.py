"""Where on the earth a map was made: GPS readings as they are stored, and the path laid over them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.sax.saxutils import escape

import numpy as np

from slam.database import MapReader
from slam.database.sensor_values import Gps
from slam.earth import TangentPlane
from slam.errors import DatabaseError
from slam.evaluate import align
from slam.geometry import Array, Pose, transform
from slam.saving import save

#: Readings that lay a map over the earth, and how far apart they must be for a direction, metres.
_LEAST, _LEAST_M = 3, 1.0
_KML = """<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2">
<Document>
<name>{name}</name>
<Placemark><name>{what}</name><LineString><altitudeMode>absolute</altitudeMode>
<coordinates>
{lines}
</coordinates></LineString></Placemark>
</Document>
</kml>
"""


def export_gps(reader: MapReader, path: Path) -> int:
    """Write the GPS readings of the nodes: as a line in a ``.kml`` file, else as text, a line for each.

    Lines are ``stamp longitude latitude altitude error bearing``.

    Returns:
        The number of readings.

    Raises:
        DatabaseError: no node has one, or the file can't be written.
    """
    readings = [gps for _, gps in sorted(reader.gps().items())]
    if not readings:
        raise DatabaseError(f"{reader.path}: no node has a GPS reading, there is nothing to export")
    if path.suffix.lower() == ".kml":
        _write_kml(path, "GPS", _geodetic(readings))
        return len(readings)
    lines = ["# stamp longitude latitude altitude error bearing"]
    lines += [
        f"{g.stamp:.6f} {g.longitude:.9f} {g.latitude:.9f} {g.altitude:.3f} {g.error:.3f} {g.bearing:.3f}"
        for g in readings
    ]
    save(path, "\n".join([*lines, ""]))
    return len(readings)


def write_kml(reader: MapReader, path: Path, ids: Sequence[int], T_map_base: Sequence[Pose]) -> None:
    """Write a path as KML, laid over the earth so that its nodes are nearest to their GPS readings.

    Raises:
        DatabaseError: fewer than three nodes of the path have a reading, all of them are at one place, or the file
            can't be written.
    """
    readings, poses = reader.gps(), dict(zip(ids, T_map_base, strict=True))
    known = [i for i in sorted(readings) if i in poses]
    if len(known) < _LEAST:
        raise DatabaseError(
            f"{reader.path}: {len(known)} nodes with a pose have a GPS reading, and {_LEAST} are needed to lay the map"
            " over the earth"
        )
    measured = _geodetic([readings[i] for i in known])
    plane = TangentPlane(*measured[0])
    enu = plane.to_enu(measured)
    if float(np.ptp(enu, axis=0).max()) < _LEAST_M:
        raise DatabaseError(f"{reader.path}: all GPS readings are within {_LEAST_M:g} m, which says no direction")
    T_enu_map = align(enu, np.array([poses[i][:3, 3] for i in known]))
    _write_kml(path, "path", plane.to_geodetic(transform(T_enu_map, np.array([T[:3, 3] for T in T_map_base]))))


def _geodetic(readings: Sequence[Gps]) -> Array:
    return np.array([(one.longitude, one.latitude, one.altitude) for one in readings], np.float64)


def _write_kml(path: Path, what: str, geodetic: Array) -> None:
    lines = "\n".join(f"{lon:.9f},{lat:.9f},{alt:.3f}" for lon, lat, alt in geodetic)
    save(path, _KML.format(name=escape(path.stem), what=what, lines=lines))
