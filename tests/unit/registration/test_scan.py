"""A node's cloud from its depth image: on the surfaces, in the base frame, as thin as asked for."""

from __future__ import annotations

import numpy as np
import pytest

from slam.clock import StageClock
from slam.geometry import Pose, make, so3_exp
from slam.params import Params, Value
from slam.registration.cells import thinned
from slam.registration.scan import depth_scan, equipped
from tests.nodes import features, node, random_descriptors
from tests.rooms import CAMERA, HEIGHT, render, tilted
from tests.tours import sparse

PARAMS = Params()
LEVEL = tilted()


def changed(**values: Value) -> Params:
    return PARAMS.changed({f"Mem/LaserScan{name}": value for name, value in values.items()})


def off_surface(points: np.ndarray, wall: float = 4.0) -> np.ndarray:
    """Distance of each point from the nearest of floor and walls, metres."""
    x, y, z = points.T
    return np.min(np.abs([x - wall, y - wall, y + wall, z + HEIGHT]), axis=0)


def test_points_lie_on_what_the_camera_sees_in_the_base_frame() -> None:
    found = depth_scan(render(LEVEL), CAMERA, changed(VoxelSize=0.0))
    assert len(found) == 160 * 120
    assert off_surface(found.points_base).max() < 1e-3
    assert found.points_base[:, 0].min() > 0, "ahead"
    assert found.normals_base is None


@pytest.mark.parametrize("step", [1, 3, 8])
def test_every_nth_pixel_is_taken(step: int) -> None:
    found = depth_scan(render(LEVEL), CAMERA, changed(VoxelSize=0.0, DownsampleStepSize=step))
    assert len(found) == -(-480 // step) * -(-640 // step)


def test_a_mounted_camera_sees_the_same_room() -> None:
    T_base_cam: Pose = make(so3_exp(np.array([0.0, 0.2, 0.0])), np.array([0.3, 0.1, 0.5])) @ CAMERA.T_base_cam
    mounted = type(CAMERA)(640, 480, CAMERA.fx, CAMERA.fy, CAMERA.cx, CAMERA.cy, T_base_cam)
    turned = depth_scan(render(tilted(pitch=0.2)), mounted, changed(VoxelSize=0.0))
    assert off_surface(turned.points_base - np.float32([0.3, 0.1, 0.5])).max() < 1e-3


def test_a_smaller_depth_image_means_the_same_places() -> None:
    z = render(LEVEL)
    small = np.ascontiguousarray((z[::2, ::2] + z[1::2, ::2] + z[::2, 1::2] + z[1::2, 1::2]) / 4, np.float32)
    found = depth_scan(small, CAMERA, changed(VoxelSize=0.0, DownsampleStepSize=1))
    assert np.median(off_surface(found.points_base)) < 1e-3
    assert len(found) == 320 * 240


def test_cubes_thin_it_and_normals_are_those_of_the_surfaces() -> None:
    found = depth_scan(render(LEVEL), CAMERA, changed(VoxelSize=0.07, NormalK=8))
    assert len(found) < 8000
    np.testing.assert_allclose(thinned(found.points_base.astype(np.float64), 0.07), found.points_base, atol=1e-6)
    assert found.normals_base is not None
    np.testing.assert_allclose(np.linalg.norm(found.normals_base, axis=1), 1, atol=1e-5)
    floor = found.points_base[:, 2] < -HEIGHT + 0.01
    assert np.median(found.normals_base[floor, 2]) > 0.999, "up, towards the camera"


@pytest.mark.parametrize("k", [0, 5])
def test_a_depth_image_that_says_nothing_is_an_empty_cloud(k: int) -> None:
    z = np.zeros((480, 640), np.float32)
    z[0, 0] = np.nan
    assert len(depth_scan(z, CAMERA, changed(NormalK=k))) == 0


@pytest.mark.parametrize(("strategy", "flow"), [(0, 0), (1, 0), (2, 1), (0, 1)])
def test_a_node_keeps_what_is_asked_for(strategy: int, flow: int) -> None:
    frame, plain, clock = sparse()[0], node(1, features(random_descriptors(5, 1)), np.ones(5, np.int32)), StageClock()
    found = equipped(plain, frame, PARAMS.changed({"Reg/Strategy": strategy, "Vis/CorType": flow}), clock)
    assert (found.scan is not None) == (strategy > 0) == ("TimingMem/Scan_filtering/ms" in clock.values)
    assert (found.images is not None) == (flow == 1)
    if found.images is not None:
        assert found.images.gray.shape == found.images.depth_m.shape == frame.depth_m.shape
