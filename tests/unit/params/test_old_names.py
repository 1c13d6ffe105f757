"""Parameters of older versions of RTAB-Map are taken under the names that they have today."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from slam.params import specs
from slam.params.ini import known_unused, read_ini
from slam.params.old_names import is_gone, todays, todays_name


@pytest.mark.parametrize(
    ("old", "text", "new", "value"),
    [
        ("Kp/WordsPerImage", "400", "Kp/MaxFeatures", "400"),
        ("Optimizer/Slam2D", "true", "Reg/Force3DoF", "true"),
        ("Grid/FromDepth", "true", "Grid/Sensor", "1"),
        ("Grid/FromDepth", "false", "Grid/Sensor", "0"),
        ("Icp/PM", "True", "Icp/Strategy", "1"),
        ("Odom/MinInliers", "20", "Vis/MinInliers", "20"),
        ("Rtabmap/LoopThr", "0,15", "Rtabmap/LoopThr", "0.15"),
        ("Kp/RoiRatios", "0.0 0.0 0.0 0.0", "Kp/RoiRatios", "0.0 0.0 0.0 0.0"),
        ("LccIcp/Type", "1", "LccIcp/Type", "1"),
        ("My/Own", "a,b", "My/Own", "a,b"),
    ],
)
def test_names_and_values_become_today_s(old: str, text: str, new: str, value: str) -> None:
    assert todays({old: text}) == {new: value}


def test_today_s_name_counts_where_both_are_given() -> None:
    both = {"Kp/MaxFeatures": "500", "Kp/WordsPerImage": "400"}
    assert todays(both) == todays(dict(reversed(both.items()))) == {"Kp/MaxFeatures": "500"}


def test_what_is_gone_is_known_and_has_no_successor() -> None:
    assert is_gone("LccIcp/Type")
    assert todays_name("LccIcp/Type") is None
    assert not is_gone("Kp/WordsPerImage")
    assert not is_gone("Rtabmap/LoopThr")


def test_every_successor_is_a_name_of_today(shared_data: Path) -> None:
    with (shared_data.parent / "ref" / "rtabmap-parameters.csv").open() as table:
        names = [row["name"] for row in csv.DictReader(table)]
    assert not [name for name in names if todays_name(name) is not None or is_gone(name)]
    registered = {spec.name for spec in specs()}
    for old in ("Aruco/Dictionary", "Grid/DepthMax", "RGBD/OptimizeSlam2d", "GFTT/MaxCorners", "SPTorch/NMS"):
        new = todays_name(old)
        assert new is not None
        assert new in registered or known_unused(new)


def test_an_ini_file_may_have_old_names(tmp_path: Path) -> None:
    path = tmp_path / "old.ini"
    path.write_text("[Core]\nKp\\WordsPerImage=350\nLccIcp\\Type=1\nRtabmap\\LoopThr=0,2\n")
    found = read_ini(path)
    assert found.values == {"Kp/MaxFeatures": "350", "Rtabmap/LoopThr": "0.2"}
    assert found.unused == {"LccIcp/Type": "1"}
