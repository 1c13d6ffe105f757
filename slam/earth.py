"""Positions on the earth: WGS 84 (NIMA TR8350.2), and the plane that touches it."""

from __future__ import annotations

import numpy as np

from slam.geometry import Array

#: Of the ellipsoid: half its longer axis in metres, and its flattening.
_A, _F = 6378137.0, 1.0 / 298.257223563
_E2 = _F * (2.0 - _F)


class TangentPlane:
    """East, north and up in metres from an origin (longitude and latitude in degrees, altitude in metres)."""

    def __init__(self, longitude: float, latitude: float, altitude: float) -> None:
        self._origin = _to_ecef(np.array([[longitude, latitude, altitude]]))[0]
        lon, lat = np.radians([longitude, latitude])
        self._R_ecef_enu = np.array(
            [
                [-np.sin(lon), -np.sin(lat) * np.cos(lon), np.cos(lat) * np.cos(lon)],
                [np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat) * np.sin(lon)],
                [0.0, np.cos(lat), np.sin(lat)],
            ]
        )

    def to_enu(self, geodetic: Array) -> Array:
        """East, north, up (N, 3) of longitudes, latitudes and altitudes (N, 3)."""
        return np.asarray((_to_ecef(geodetic) - self._origin) @ self._R_ecef_enu)

    def to_geodetic(self, enu: Array) -> Array:
        """Longitudes, latitudes and altitudes (N, 3) of east, north, up (N, 3)."""
        return _to_geodetic(self._origin + enu @ self._R_ecef_enu.T)


def _to_ecef(geodetic: Array) -> Array:
    lon, lat = np.radians(geodetic[:, 0]), np.radians(geodetic[:, 1])
    normal = _A / np.sqrt(1.0 - _E2 * np.sin(lat) ** 2)
    across = (normal + geodetic[:, 2]) * np.cos(lat)
    return np.column_stack(
        [across * np.cos(lon), across * np.sin(lon), (normal * (1.0 - _E2) + geodetic[:, 2]) * np.sin(lat)]
    )


def _to_geodetic(ecef: Array) -> Array:
    """By iteration of the latitude, which converges to a nanometre in five steps anywhere near the ground."""
    across = np.hypot(ecef[:, 0], ecef[:, 1])
    lat = np.arctan2(ecef[:, 2], across * (1.0 - _E2))
    for _ in range(6):
        normal = _A / np.sqrt(1.0 - _E2 * np.sin(lat) ** 2)
        lat = np.arctan2(ecef[:, 2] + _E2 * normal * np.sin(lat), across)
    normal = _A / np.sqrt(1.0 - _E2 * np.sin(lat) ** 2)
    # From whichever of both axes the point is farther: near the poles a cosine is none to divide by.
    steep = np.abs(lat) > np.pi / 4
    by_height = ecef[:, 2] / np.where(steep, np.sin(lat), 1.0) - normal * (1.0 - _E2)
    by_distance = across / np.where(steep, 1.0, np.cos(lat)) - normal
    altitude = np.where(steep, by_height, by_distance)
    return np.column_stack([np.degrees(np.arctan2(ecef[:, 1], ecef[:, 0])), np.degrees(lat), altitude])
