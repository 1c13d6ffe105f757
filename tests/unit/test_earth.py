"""The plane that touches the earth: known places, and there and back."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from slam.earth import TangentPlane


def test_a_degree_has_its_known_length() -> None:
    """At the equator, 1 degree of longitude is 111,319.5 m along the ground and one of latitude 110,574 m."""
    plane = TangentPlane(0.0, 0.0, 0.0)
    found = plane.to_enu(np.array([[0.001, 0.0, 0.0], [0.0, 0.001, 0.0], [0.0, 0.0, 7.0]]))
    np.testing.assert_allclose(found[0], [111.3195, 0.0, 0.0], atol=2e-3)
    np.testing.assert_allclose(found[1], [0.0, 110.574, 0.0], atol=2e-3)
    np.testing.assert_allclose(found[2], [0.0, 0.0, 7.0], atol=1e-6)


@given(
    lon=st.floats(-180, 180),
    lat=st.floats(-90, 90),
    altitude=st.floats(-400, 9000),
    east=st.floats(-5000, 5000),
    north=st.floats(-5000, 5000),
    up=st.floats(-100, 1000),
)
def test_there_and_back_is_where_one_was(
    lon: float, lat: float, altitude: float, east: float, north: float, up: float
) -> None:
    plane = TangentPlane(lon, lat, altitude)
    enu = np.array([[east, north, up]])
    np.testing.assert_allclose(plane.to_enu(plane.to_geodetic(enu)), enu, atol=1e-5)
