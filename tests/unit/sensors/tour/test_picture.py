"""Exact pictures: against rays cast one by one."""

from __future__ import annotations

import numpy as np
import pytest

from slam.camera import Camera
from slam.geometry import Pose, inverse, make, so3_exp
from slam.sensors.tour.picture import picture
from slam.sensors.tour.scene import Scene, load_scene

CAMERA = Camera(160, 120, 130.0, 131.0, 79.5, 59.5)


def somewhere(rng: np.random.Generator) -> Pose:
    turn = so3_exp(np.array([0, 0, rng.uniform(-3, 3)])) @ so3_exp(np.array([0, rng.uniform(-0.8, 0.8), 0]))
    return make(turn, np.array([rng.uniform(1, 2), rng.uniform(6, 8.5), rng.uniform(0.5, 2.0)]))


def ray_cast(scene: Scene, T_world_cam: Pose, u: float, v: float) -> float:
    """1/z of the nearest face, front side, that a pixel's ray meets."""
    ray = T_world_cam[:3, :3] @ np.array([(u - CAMERA.cx) / CAMERA.fx, (v - CAMERA.cy) / CAMERA.fy, 1.0])
    normals = np.cross(scene.rights, scene.downs)
    facing = normals @ ray
    with np.errstate(divide="ignore", invalid="ignore"):
        z = ((scene.origins - T_world_cam[:3, 3]) * normals).sum(1) / facing
        hit = T_world_cam[:3, 3] + z[:, None] * ray - scene.origins
        a = (hit * scene.rights).sum(1) / (scene.rights**2).sum(1)
        b = (hit * scene.downs).sum(1) / (scene.downs**2).sum(1)
        ok = (facing > 0) & (z > 0.05) & (a >= 0) & (a <= 1) & (b >= 0) & (b <= 1)
    return float(1 / z[ok].min()) if ok.any() else 0.0


@pytest.mark.parametrize("seed", range(6))
def test_depth_is_what_rays_find(seed: int) -> None:
    rng = np.random.default_rng(seed)
    T_world_cam = somewhere(rng) @ CAMERA.T_base_cam
    _, inverse_z = picture(load_scene(), CAMERA, inverse(T_world_cam))
    pixels = rng.integers([0, 0], [CAMERA.width, CAMERA.height], (300, 2))
    found = np.array([inverse_z[v, u] for u, v in pixels])
    cast = np.array([ray_cast(load_scene(), T_world_cam, u, v) for u, v in pixels])
    assert np.mean(np.abs(found - cast) < 1e-9) > 0.99, "all but rays through an edge"


@pytest.mark.parametrize("seed", range(12))
def test_the_flat_has_no_holes(seed: int) -> None:
    T_world_cam = somewhere(np.random.default_rng(seed)) @ CAMERA.T_base_cam
    image, inverse_z = picture(load_scene(), CAMERA, inverse(T_world_cam))
    assert inverse_z.min() > 1 / 20
    assert image.min() >= 0
    assert image.max() < 255.5


def test_a_picture_at_twice_the_size_shows_the_same() -> None:
    """Filtering over each pixel's footprint: halving the large picture gives the small one."""
    T_cam_world = inverse(somewhere(np.random.default_rng(1)) @ CAMERA.T_base_cam)
    double = Camera(320, 240, 260.0, 262.0, 159.5, 119.5)
    small, _ = picture(load_scene(), CAMERA, T_cam_world)
    large, _ = picture(load_scene(), double, T_cam_world)
    halved = large.reshape(120, 2, 160, 2, 3).mean(axis=(1, 3))
    assert np.abs(halved - small).mean() < 3.0
