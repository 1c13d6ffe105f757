"""The rendered tour as a sensor source."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from slam.camera import Camera
from slam.geometry import inverse
from slam.sensors.ahead import ahead
from slam.sensors.gravity import level
from slam.sensors.tour.kinect import measure
from slam.sensors.tour.options import TourOptions
from slam.sensors.tour.path import Walk
from slam.sensors.tour.picture import picture
from slam.sensors.tour.scene import load_scene
from slam.sensors.tour.shade import finish
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
        image, inverse_z = picture(load_scene(), self.camera, inverse(T_world_base @ self.camera.T_base_cam))
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
