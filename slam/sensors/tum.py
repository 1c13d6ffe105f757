"""Folders in the format of the TUM RGB-D benchmark."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.errors import SourceError
from slam.geometry import inverse
from slam.sensors.ahead import ahead
from slam.sensors.calibration import read_calibration
from slam.sensors.gravity import Gravity
from slam.sensors.images import read_color, read_depth
from slam.sensors.lists import read_image_list
from slam.sensors.rectify import make_rectifier
from slam.sensors.truth import Truth
from slam.sensors.wheels import Wheels
from slam.stamps import pair_nearest
from slam.types import Frame

#: Colour and depth farther apart in time are not one frame.
PAIR_WITHIN_S = 0.02


class TumFolder:
    """A recorded sequence: rgb.txt, depth.txt and, where present, groundtruth.txt, accelerometer.txt, calibration.yaml,
    and odometry.txt (poses of the base) or wheels.txt (planar increments with sigmas).

    Colour and depth are paired one-to-one by nearest stamps within 20 ms; a frame has the stamp of its colour image.

    Raises:
        SourceError: at opening for all that lists, calibration and the first pair tell; at a frame for its images.
    """

    live = False

    def __init__(self, folder: Path) -> None:
        _check_folder(folder)
        colors, depths = read_image_list(folder / "rgb.txt"), read_image_list(folder / "depth.txt")
        pairs = pair_nearest(colors.stamps, depths.stamps, PAIR_WITHIN_S)
        if not len(pairs):
            raise SourceError(
                f"{folder}: no colour and depth image within 20 ms of each other (rgb.txt starts at "
                f"{colors.stamps[0]:.6f}, depth.txt at {depths.stamps[0]:.6f}); both need the same clock"
            )
        self.name = folder.resolve().name
        self._pairs = [(float(colors.stamps[i]), colors.files[i], depths.files[j]) for i, j in pairs]
        self._delays_s = (depths.stamps[pairs[:, 1]] - colors.stamps[pairs[:, 0]]).tolist()
        self._calibration = read_calibration(folder)
        self._rectifier = make_rectifier(self._calibration)
        self._truth = Truth.read(folder / "groundtruth.txt")
        self._gravity = Gravity.read(folder / "accelerometer.txt")
        self._wheels = Wheels.read(folder)
        self._images(0)

    @property
    def camera(self) -> Camera:
        """Camera of the rectified images."""
        return self._calibration.camera

    def __len__(self) -> int:
        return len(self._pairs)

    def __iter__(self) -> Iterator[Frame]:
        return ahead(len(self), self._load)

    def _load(self, index: int) -> Frame:
        stamp = self._pairs[index][0]
        image, depth = self._images(index)
        T_world_cam = self._truth.at(stamp)
        return Frame(
            index=index,
            stamp=stamp,
            image_bgr=self._rectifier.color(image),
            depth_m=self._rectifier.depth(depth).astype(np.float32) / np.float32(self._calibration.depth_factor),
            camera=self.camera,
            T_world_base=None if T_world_cam is None else T_world_cam @ inverse(self.camera.T_base_cam),
            T_gravity_base=self._gravity.at(stamp, self.camera),
            depth_delay_s=self._delays_s[index],
            external=self._wheels.at(stamp),
        )

    def _images(self, index: int) -> tuple[NDArray[np.uint8], NDArray[np.uint16]]:
        _, color_file, depth_file = self._pairs[index]
        image, depth = read_color(color_file), read_depth(depth_file)
        expected = (self.camera.height, self.camera.width)
        for path, size in ((color_file, image.shape[:2]), (depth_file, depth.shape)):
            if size != expected:
                raise SourceError(
                    f"{path}: {size[1]}x{size[0]} pixels, but the calibration says {expected[1]}x{expected[0]}; "
                    "colour, depth and calibration must have one size"
                )
        return image, depth


def _check_folder(folder: Path) -> None:
    right = "a TUM folder has rgb.txt, depth.txt and calibration.yaml"
    if not folder.exists():
        raise SourceError(f"{folder}: no such folder; {right}, and `tour:` needs no folder")
    if not folder.is_dir():
        raise SourceError(f"{folder}: is a file, not a folder; {right}")
    if not any(folder.iterdir()):
        raise SourceError(f"{folder}: the folder is empty; {right}")
