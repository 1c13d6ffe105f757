"""Exact pictures: against rays cast one by one."""

from __future__ import annotations

import numpy as np
import pytest

from slam.camera import Camera
from slam.geometry import Pose, inverse, make, so3_exp, transform
from slam.sensors.tour.atlas import make_atlas, texture_size
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


def wall(texture: np.ndarray) -> Scene:
    """One wall, 4 by 3 m, 3 m east of the origin."""
    atlas = make_atlas([texture_size(texture.shape[1], texture.shape[0])], [np.rint(texture).astype(np.uint8)])
    return Scene(*(np.array([vector], float) for vector in ((3, 2, 1.5), (0, -4, 0), (0, 0, -3))), atlas)


def gradient_wall() -> Scene:
    """Its blue rises to the right and its green rises downwards."""
    v, u = (np.mgrid[:384, :512] + 0.5) / np.array([384, 512])[:, None, None]
    return wall(np.dstack([20 + 200 * u, 20 + 200 * v, np.full_like(u, 77)]))


@pytest.mark.parametrize("seed", range(5))
def test_colours_lie_where_the_wall_has_them(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = so3_exp(rng.uniform(-0.4, 0.4, 3))
    T_world_cam = make(turn, np.array([rng.uniform(-1, 2), *rng.uniform(-0.5, 0.5, 2)])) @ CAMERA.T_base_cam
    image, inverse_z = picture(gradient_wall(), CAMERA, inverse(T_world_cam))
    v, u = np.nonzero(inverse_z[5:-5, 5:-5])
    u, v = u + 5, v + 5
    points = transform(T_world_cam, CAMERA.unproject(np.column_stack([u, v]), 1 / inverse_z[v, u]))
    assert np.allclose(points[:, 0], 3.0, atol=1e-9)
    right, down = (2 - points[:, 1]) / 4, (1.5 - points[:, 2]) / 3
    inner = (np.minimum(right, down) > 0.06) & (np.maximum(right, down) < 0.94)
    expected = np.column_stack([20 + 200 * right, 20 + 200 * down, np.full_like(down, 77)])
    assert np.count_nonzero(inner) > 2000
    assert np.abs(image[v, u] - expected)[inner].max() < 1.5


def test_pixels_are_the_mean_of_what_they_cover() -> None:
    """Against a picture of 6 by 6 rays a pixel: textures, however fine, and edges."""
    rng = np.random.default_rng(1)
    fine = Camera(960, 720, 6 * 130.0, 6 * 131.0, 6 * 80 - 0.5, 6 * 60 - 0.5)
    errors, edge_errors = [], []
    for _ in range(3):
        T_cam_world = inverse(somewhere(rng) @ CAMERA.T_base_cam)
        small, inverse_z = picture(load_scene(), CAMERA, T_cam_world)
        large, fine_inverse_z = picture(load_scene(), fine, T_cam_world)
        mean = large.reshape(120, 6, 160, 6, 3).mean(axis=(1, 3))
        within = np.ptp(fine_inverse_z.reshape(120, 6, 160, 6), axis=(1, 3)) > 0.3 * inverse_z
        errors.append(np.abs(mean - small)[2:-2, 2:-2].ravel())
        edge_errors.append(np.abs(mean - small)[within].ravel())
    assert np.concatenate(errors).mean() < 2.2
    assert np.concatenate(edge_errors).mean() < 9.0


def test_what_is_finer_than_a_pixel_is_its_mean() -> None:
    v, u = np.mgrid[:1536, :2048]
    checks = wall(np.dstack([200.0 * ((u + v) % 2)] * 3))
    for turn in (0.0, 0.7):
        T_world_cam = make(so3_exp(np.array([0.0, 0.0, turn])), np.zeros(3)) @ CAMERA.T_base_cam
        image, inverse_z = picture(checks, CAMERA, inverse(T_world_cam))
        inside = np.zeros(inverse_z.shape, bool)
        inside[4:-4, 4:-4] = inverse_z[4:-4, 4:-4] > 0
        assert np.count_nonzero(inside) > 3000
        seen = image[inside]
        assert abs(seen.mean() - 100) < 2
        assert seen.std() < 6
