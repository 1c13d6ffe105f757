"""The rendered tour as a sensor source."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Pose, inverse
from slam.sensors.ahead import ahead
from slam.sensors.gravity import level
from slam.sensors.tour.kinect import measure
from slam.sensors.tour.options import TourOptions
from slam.sensors.tour.path import Walk
from slam.sensors.tour.raster import visible
from slam.sensors.tour.scene import Scene, load_scene
from slam.sensors.tour.shade import finish, shade, smooth_edges
from slam.types import Frame

#: Any fixed date: the same tour has the same stamps.
START_S = 1_700_000_000.0
#: Focal length for an image width of one: that of a Kinect, 63 degrees across.
_FOCAL = 525.0 / 640.0
_COLOR_NOISE = 1.5
#: Noise is drawn once and begun elsewhere in each frame: fresh normal numbers would take longer than the picture.
_NOISE_TABLE = 1 << 20


class Tour:
    """Frames of a walk through the rendered flat; the same options give the same frames, bit for bit."""

    live = False

    def __init__(self, options: TourOptions) -> None:
        self.name = str(options)
        self._options = options
        self._walk = Walk(options)
        width, height = options.width, options.height
        focal = _FOCAL * width
        self.camera = Camera(width, height, focal, focal, width / 2 - 0.5, height / 2 - 0.5)
        self._noise = np.random.default_rng([options.seed, 2]).standard_normal(_NOISE_TABLE, np.float32)

    def __len__(self) -> int:
        seconds = self._options.laps * self._walk.lap_m / self._options.speed
        whole = int(seconds * self._options.fps)
        return min(self._options.frames, whole) if self._options.frames else whole

    def __iter__(self) -> Iterator[Frame]:
        return ahead(len(self), self.render)

    def render(self, index: int) -> Frame:
        """The frame of this index, whatever was rendered before."""
        time_s = index / self._options.fps
        T_world_base = self._walk.T_world_base(time_s)
        image, inverse_z = _picture(load_scene(), self.camera, inverse(T_world_base @ self.camera.T_base_cam))
        rng = np.random.default_rng([self._options.seed, 3, index])
        color_start, depth_start = (int(start) for start in rng.integers(0, _NOISE_TABLE, 2))
        image_bgr, depth_m = np.empty(image.shape, np.uint8), np.empty(inverse_z.shape, np.float32)
        finish(image, self._noise, color_start, _COLOR_NOISE, image_bgr)
        measure(inverse_z, self._noise, depth_start, self.camera.fx, depth_m)
        return Frame(
            index=index,
            stamp=START_S + time_s,
            image_bgr=image_bgr,
            depth_m=depth_m,
            camera=self.camera,
            T_world_base=T_world_base,
            T_gravity_base=level(T_world_base[2, :3]),
        )


def _picture(scene: Scene, camera: Camera, T_cam_world: Pose) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """Colour (H, W, 3), 0 to 255, and exact 1/z (H, W) in 1/m of what a camera sees."""
    R, size = T_cam_world[:3, :3], (camera.height, camera.width)
    origins, rights, downs = scene.origins @ R.T + T_cam_world[:3, 3], scene.rights @ R.T, scene.downs @ R.T
    corners = np.stack([origins, origins + rights, origins + rights + downs, origins + downs], axis=1)
    face, inverse_z = np.empty(size, np.int32), np.empty(size)
    visible(corners, camera.K, face, inverse_z)
    planes = _texture_planes(origins, rights, downs, scene.atlas.levels[:, 0, 1:])
    image = np.empty((*size, 3), np.float32)
    for paint in (shade, smooth_edges):
        paint(face, planes, scene.atlas.texels, scene.atlas.levels, camera.K, image)
    return image, inverse_z


def _texture_planes(
    origins: NDArray[np.float64], rights: NDArray[np.float64], downs: NDArray[np.float64], sizes: NDArray[np.int64]
) -> NDArray[np.float64]:
    """(F, 3, 3) from a ray (x, y, 1) in the camera to homogeneous texture coordinates; the last is 1/z.

    With the plane's normal n and distance d, z = d / (n . ray) and u = (z ray - origin) . right / |right|^2 * width.
    """
    normals = np.cross(rights, downs)
    inverse_z = normals / (normals * origins).sum(1, keepdims=True)
    axes = (edges * (sizes[:, [k]] / (edges**2).sum(1, keepdims=True)) for k, edges in enumerate((rights, downs)))
    rows = [axis - (origins * axis).sum(1, keepdims=True) * inverse_z for axis in axes]
    return np.stack([*rows, inverse_z], axis=1)
