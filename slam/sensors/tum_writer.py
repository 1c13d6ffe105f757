"""Any source as a folder in the format of the TUM RGB-D benchmark."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.errors import SourceError
from slam.geometry import to_quat_xyzw
from slam.sensors.calibration import write_calibration
from slam.sensors.gravity import GRAVITY, R_CAM_ACCELEROMETER
from slam.sensors.source import Source
from slam.types import Frame

#: Stored depth of one metre, as in the benchmark; what lies beyond 13.1 m does not fit and becomes unknown.
DEPTH_FACTOR = 5000.0
_JPEG_QUALITY = 95


@dataclass(slots=True)
class _Lists:
    """Lines of the folder's text files, by file name."""

    lines: dict[str, list[str]] = field(default_factory=dict)

    def add(self, name: str, text: str) -> None:
        self.lines.setdefault(name, []).append(text + "\n")

    def write(self, folder: Path) -> None:
        for name, lines in self.lines.items():
            (folder / name).write_text("".join(lines), encoding="utf-8")


def write_tum_folder(source: Source, folder: Path, frames: int | None = None) -> int:
    """Write the first ``frames`` frames (None: all) of a source; returns how many.

    Colour becomes JPEG, depth a 16-bit PNG; ground truth, attitude (as accelerometer readings) and calibration follow
    where the source has them. The camera's place on the base is not part of the format: a reader takes the base
    frame to be the optical frame with its axes exchanged.

    Raises:
        SourceError: the folder exists and is not empty, or it can't be written.
    """
    try:
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise SourceError(f"{folder}: exists already; name a folder that is new or empty")
        for name in ("rgb", "depth"):
            (folder / name).mkdir(parents=True, exist_ok=True)
        lists, count = _Lists(), 0
        for frame in islice(source, frames):
            _write_frame(frame, folder, lists)
            count += 1
        lists.write(folder)
        write_calibration(folder, source.camera, DEPTH_FACTOR)
    except OSError as error:
        raise SourceError(f"{folder}: can't be written ({error.strerror})") from error
    return count


def _write_frame(frame: Frame, folder: Path, lists: _Lists) -> None:
    stamp = f"{frame.stamp:.6f}"
    color, depth = f"rgb/{stamp}.jpg", f"depth/{stamp}.png"
    steps = np.rint(frame.depth_m * DEPTH_FACTOR)
    stored = np.where(steps < np.iinfo(np.uint16).max, steps, 0).astype(np.uint16)
    (folder / color).write_bytes(_encoded(".jpg", frame.image_bgr, [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY]))
    (folder / depth).write_bytes(_encoded(".png", stored, [cv2.IMWRITE_PNG_COMPRESSION, 4]))
    lists.add("rgb.txt", f"{stamp} {color}")
    lists.add("depth.txt", f"{stamp} {depth}")
    if frame.T_world_base is not None:
        T_world_cam = frame.T_world_base @ frame.camera.T_base_cam
        values = [*T_world_cam[:3, 3], *to_quat_xyzw(T_world_cam)]
        lists.add("groundtruth.txt", " ".join([stamp, *(f"{value:.7f}" for value in values)]))
    if frame.T_gravity_base is not None:
        R_gravity_sensor = frame.T_gravity_base[:3, :3] @ frame.camera.T_base_cam[:3, :3] @ R_CAM_ACCELEROMETER
        lists.add("accelerometer.txt", " ".join([stamp, *(f"{GRAVITY * up:.6f}" for up in R_gravity_sensor[2])]))


def _encoded(kind: str, image: NDArray[np.integer], options: list[int]) -> bytes:
    ok, data = cv2.imencode(kind, image, options)
    if not ok:
        raise SourceError(f"an image of {image.shape} {image.dtype} can't be encoded as {kind}")
    return bytes(data)
