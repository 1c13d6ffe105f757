"""Intrinsics: from the file, from the folder's name, or refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from slam.camera import Camera
from slam.errors import SourceError
from slam.sensors.calibration import read_calibration, write_calibration

GOOD = {
    "image_width": "640",
    "image_height": "480",
    "fx": "525.0",
    "fy": "524.5",
    "cx": "319.5",
    "cy": "239.5",
    "depth_factor": "5000",
}


def write(folder: Path, **changes: str | None) -> Path:
    values = {**GOOD, **changes}
    lines = [f"{key}: {value}" for key, value in values.items() if value is not None]
    (folder / "calibration.yaml").write_text("\n".join(lines))
    return folder


def test_what_is_written_is_read(tmp_path: Path) -> None:
    camera = Camera(320, 200, 0.1 + 0.2 + 260, 262.0, 159.5, 100.25)
    write_calibration(tmp_path, camera, 1000.0)
    back = read_calibration(tmp_path)
    assert (back.depth_factor, back.distortion) == (1000.0, ())
    for name in ("width", "height", "fx", "fy", "cx", "cy"):
        assert getattr(back.camera, name) == getattr(camera, name)


def test_distortion_of_zeros_is_none(tmp_path: Path) -> None:
    assert read_calibration(write(tmp_path, distortion="[0.1, -0.2, 0, 0]")).distortion == (0.1, -0.2, 0.0, 0.0)
    assert read_calibration(write(tmp_path, distortion="[0, 0, 0, 0, 0]")).distortion == ()


@pytest.mark.parametrize(
    ("name", "fx", "distorted"),
    [
        ("rgbd_dataset_freiburg1_xyz", 517.306408, True),
        ("rgbd_dataset_freiburg2_desk", 520.908620, True),
        ("RGBD_Freiburg3_office", 535.4, False),
        ("fr1_desk", 517.306408, True),
    ],
)
def test_the_benchmarks_cameras_are_known_by_name(tmp_path: Path, name: str, fx: float, distorted: bool) -> None:
    (tmp_path / name).mkdir()
    found = read_calibration(tmp_path / name)
    assert found.camera.fx == fx
    assert bool(found.distortion) == distorted
    assert found.depth_factor == 5000.0


@pytest.mark.parametrize("name", ["kitchen", "freiburg4_x", "fr12"])
def test_other_names_need_a_calibration(tmp_path: Path, name: str) -> None:
    (tmp_path / name).mkdir()
    with pytest.raises(SourceError, match=r"write calibration\.yaml with image_width"):
        read_calibration(tmp_path / name)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"fx": None, "cy": None}, "has no fx, cy; expected image_width"),
        ({"fz": "3"}, "has unknown fz; expected image_width"),
        ({"fx": "-525"}, "fx is -525; expected a number from 64 to 6400"),
        ({"fx": "wide"}, "fx is 'wide'; expected a number"),
        ({"fy": ".nan"}, "fy is nan; expected a number"),
        ({"cx": "2000"}, "cx is 2000; expected a number from 0 to 640"),
        ({"image_width": "640.5"}, "image_width is 640.5; expected a whole number of pixels"),
        ({"image_height": "0"}, "image_height is 0; expected a number from 16"),
        ({"depth_factor": "0"}, "depth_factor is 0; expected a number from 1"),
        ({"depth_factor": "true"}, "depth_factor is True; expected a number"),
        ({"distortion": "[0.1, 0.2]"}, r"distortion is \[0.1, 0.2\]; expected a list k1, k2, p1, p2"),
        ({"distortion": "0.1"}, "distortion is 0.1; expected a list"),
        ({"distortion": "[a, b, c, d]"}, "expected a list k1"),
    ],
)
def test_absurd_calibrations_are_refused(tmp_path: Path, changes: dict[str, str | None], message: str) -> None:
    with pytest.raises(SourceError, match=message):
        read_calibration(write(tmp_path, **changes))


@pytest.mark.parametrize("text", ["fx: [1, 2", "just words", "- 1\n- 2\n", ""])
def test_what_is_no_yaml_mapping_is_refused_in_one_line(tmp_path: Path, text: str) -> None:
    (tmp_path / "calibration.yaml").write_text(text)
    with pytest.raises(SourceError, match=r"calibration\.yaml: ") as caught:
        read_calibration(tmp_path)
    assert "\n" not in str(caught.value)
