"""The rendered tour as a sensor source."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import inverse
from slam.sensors.ahead import ahead
from slam.sensors.gravity import level
from slam.sensors.tour.kinect import measure
from slam.sensors.tour.options import TourOptions
from slam.sensors.tour.path import Walk
from slam.sensors.tour.raster import visible
from slam.sensors.tour.scene import load_scene
from slam.sensors.tour.shade import shade
from slam.types import Frame

#: Any fixed date: the same tour has the same stamps.
START_S = 1_700_000_000.0
_FOCAL = 525.0 / 640.0
_COLOR_NOISE = 1.5
_NOISE_TABLE = 1 << 20


class Tour:
    """Frames of a walk through the rendered flat; the same options give the same frames, bit for bit."""

    live = False

    def __init__(self, options: TourOptions) -> None:
        self.name = str(options)
        self._options = options
        self._walk = Walk(options)
        focal = _FOCAL * options.width
        self.camera = Camera(
            options.width, options.height, focal, focal, options.width / 2 - 0.5, options.height / 2 - 0.5
        )
        self._scene = load_scene()
        self._noise = np.random.default_rng([options.seed, 2]).standard_normal(_NOISE_TABLE, np.float32)

    def __len__(self) -> int:
        seconds = self._options.laps * self._walk.lap_m / self._options.speed
        whole = int(seconds * self._options.fps)
        return min(self._options.frames, whole) if self._options.frames else whole

    def __iter__(self) -> Iterator[Frame]:
        return ahead(len(self), self.render)

    def render(self, index: int) -> Frame:
        """Frame of this index; independent of what was rendered before."""
        camera = self.camera
        time_s = index / self._options.fps
        T_world_base = self._walk.T_world_base(time_s)
        T_cam_world = inverse(T_world_base @ camera.T_base_cam)
        size = (camera.height, camera.width)
        face, inverse_z = np.empty(size, np.int32), np.empty(size)
        origins = self._scene.origins @ T_cam_world[:3, :3].T + T_cam_world[:3, 3]
        rights, downs = self._scene.rights @ T_cam_world[:3, :3].T, self._scene.downs @ T_cam_world[:3, :3].T
        corners = np.stack([origins, origins + rights, origins + rights + downs, origins + downs], axis=1)
        visible(corners, camera.K, face, inverse_z)
        atlas = self._scene.atlas
        image = np.empty((*size, 3), np.float32)
        shade(face, _planes(origins, rights, downs, atlas.levels), atlas.texels, atlas.levels, camera.K, image)
        rng = np.random.default_rng([self._options.seed, 3, index])
        image += _COLOR_NOISE * self._draw(rng, image.size).reshape(image.shape)
        depth_m = np.empty(size, np.float32)
        measure(inverse_z, self._draw(rng, depth_m.size).reshape(size), camera.fx, depth_m)
        return Frame(
            index=index,
            stamp=START_S + time_s,
            image_bgr=np.clip(np.rint(image), 0, 255).astype(np.uint8),
            depth_m=depth_m,
            camera=camera,
            T_world_base=T_world_base,
            T_gravity_base=level(T_world_base[2, :3]),
        )

    def _draw(self, rng: np.random.Generator, count: int) -> NDArray[np.float32]:
        """Noise from one table, begun anywhere: fresh normal numbers would take longer than the picture."""
        start = int(rng.integers(len(self._noise)))
        return np.resize(np.roll(self._noise, -start), count)


def _planes(
    origins: NDArray[np.float64], rights: NDArray[np.float64], downs: NDArray[np.float64], levels: NDArray[np.int64]
) -> NDArray[np.float64]:
    """(F, 3, 3) from rays (x, y, 1) to homogeneous texture coordinates of level 0."""
    normals = np.cross(rights, downs)
    distances = (normals * origins).sum(1, keepdims=True)
    u = rights * (levels[:, 0, 1] / (rights**2).sum(1))[:, None]
    v = downs * (levels[:, 0, 2] / (downs**2).sum(1))[:, None]
    rows = [distances * axis - (origins * axis).sum(1, keepdims=True) * normals for axis in (u, v)]
    return np.stack([*rows, normals], axis=1)
