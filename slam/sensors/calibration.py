"""Intrinsics of a TUM folder: its calibration.yaml, or the published ones of the freiburg cameras."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import yaml

from slam.camera import Camera
from slam.errors import SourceError

_REQUIRED = ("image_width", "image_height", "fx", "fy", "cx", "cy", "depth_factor")
_OPTIONAL = ("distortion",)

#: fx fy cx cy and k1 k2 p1 p2 k3 of the benchmark's colour cameras (TUM RGB-D file formats page), 640x480.
_FREIBURG: Mapping[str, tuple[tuple[float, float, float, float], tuple[float, ...]]] = {
    "1": ((517.306408, 516.469215, 318.643040, 255.313989), (0.262383, -0.953104, -0.005358, 0.002628, 1.163314)),
    "2": ((520.908620, 521.007327, 325.141442, 249.701764), (0.231222, -0.784899, -0.003257, -0.000105, 0.917205)),
    "3": ((535.4, 539.2, 320.1, 247.6), ()),
}
_FREIBURG_DEPTH_FACTOR = 5000.0


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """Camera of the rectified images, and what turns the stored ones into them.

    Attributes:
        camera: pinhole camera after rectification (same K as before).
        distortion: OpenCV's k1 k2 p1 p2 [k3 [k4 k5 k6]] of the stored images, empty when they are rectified.
        depth_factor: stored depth value of one metre.
    """

    camera: Camera
    distortion: tuple[float, ...]
    depth_factor: float


def read_calibration(folder: Path) -> Calibration:
    """Calibration of a TUM folder.

    Raises:
        SourceError: the file is no calibration, or there is none and the folder's name tells no freiburg camera.
    """
    path = folder / "calibration.yaml"
    if path.exists():
        return _checked(path, _read(path))
    camera_number = re.search(r"(?:freiburg|fr)([123])(?![0-9])", folder.resolve().name.lower())
    if camera_number is None:
        raise SourceError(
            f"{folder}: no calibration.yaml, and the folder's name is not one of freiburg1, 2 or 3; "
            f"write calibration.yaml with {', '.join(_REQUIRED)} and, unless rectified, distortion"
        )
    (fx, fy, cx, cy), distortion = _FREIBURG[camera_number[1]]
    return Calibration(Camera(640, 480, fx, fy, cx, cy), distortion, _FREIBURG_DEPTH_FACTOR)


def write_calibration(folder: Path, camera: Camera, depth_factor: float) -> None:
    """Write calibration.yaml of rectified images."""
    values = (camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, depth_factor)
    text = "".join(f"{key}: {value!r}\n" for key, value in zip(_REQUIRED, values, strict=True))
    (folder / "calibration.yaml").write_text(text, encoding="utf-8")


def _read(path: Path) -> dict[str, object]:
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        reason = " ".join(str(error).split())
        raise SourceError(f"{path}: can't be read as YAML ({reason})") from error
    if not isinstance(content, dict):
        raise SourceError(f"{path}: expected lines `key: value` with {', '.join(_REQUIRED)}")
    return content


def _checked(path: Path, content: Mapping[str, object]) -> Calibration:
    missing = [key for key in _REQUIRED if key not in content]
    unknown = [str(key) for key in content if key not in _REQUIRED + _OPTIONAL]
    if missing or unknown:
        said = [f"has no {', '.join(missing)}"] * bool(missing) + [f"has unknown {', '.join(unknown)}"] * bool(unknown)
        raise SourceError(f"{path}: {' and '.join(said)}; expected {', '.join(_REQUIRED + _OPTIONAL)}")
    width = _number(path, content, "image_width", 16, 16384)
    height = _number(path, content, "image_height", 16, 16384)
    for key, value in (("image_width", width), ("image_height", height)):
        if value != int(value):
            raise SourceError(f"{path}: {key} is {value:g}; expected a whole number of pixels")
    camera = Camera(
        int(width),
        int(height),
        fx=_number(path, content, "fx", 0.1 * width, 10 * width),
        fy=_number(path, content, "fy", 0.1 * width, 10 * width),
        cx=_number(path, content, "cx", 0, width),
        cy=_number(path, content, "cy", 0, height),
    )
    return Calibration(camera, _distortion(path, content), _number(path, content, "depth_factor", 1, 1e6))


def _number(path: Path, content: Mapping[str, object], key: str, low: float, high: float) -> float:
    value = content[key]
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise SourceError(f"{path}: {key} is {value!r}; expected a number from {low:g} to {high:g}")
    return float(value)


def _distortion(path: Path, content: Mapping[str, object]) -> tuple[float, ...]:
    values = content.get("distortion", [])
    numbers = isinstance(values, list) and all(
        isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 100 for value in values
    )
    if not numbers or not isinstance(values, list) or len(values) not in (0, 4, 5, 8):
        raise SourceError(f"{path}: distortion is {values!r}; expected a list k1, k2, p1, p2 [, k3 [, k4, k5, k6]]")
    return tuple(float(value) for value in values) if any(values) else ()
