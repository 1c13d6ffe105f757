"""RTAB-Map's parameter files."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from slam.errors import ParameterError
from slam.params import Params, specs
from slam.params.ini import known_unused, read_ini

TYPICAL = r"""; written by rtabmap
[CalibrationDialog]
board_width=8
max_scale=1

[Core]
Version=0.23.8
Rtabmap\LoopThr=0.15
Rtabmap/TimeThr = 700
Mem\RehearsalSimilarity="0.45"
SURF\Upright=500
RGBD\OptimizeFromGraphEnd=true
Rtabmap\WorkingDirectory=

[Gui]
General\imagesKept=true
"""


def write(folder: Path, text: str) -> Path:
    path = folder / "rtabmap.ini"
    path.write_text(text)
    return path


def test_a_file_of_rtabmap_is_read(tmp_path: Path) -> None:
    found = read_ini(write(tmp_path, TYPICAL))
    assert found.values == {
        "Rtabmap/LoopThr": "0.15",
        "Rtabmap/TimeThr": "700",
        "Mem/RehearsalSimilarity": "0.45",
        "RGBD/OptimizeFromGraphEnd": "true",
    }
    assert found.unused == {"SURF/Upright": "500", "Rtabmap/WorkingDirectory": ""}
    params = Params().changed(found.values)
    assert (params.Rtabmap.LoopThr, params.Rtabmap.TimeThr) == (0.15, 700.0)
    assert params.RGBD.OptimizeFromGraphEnd is True


def test_plain_lines_need_no_section(tmp_path: Path) -> None:
    assert read_ini(write(tmp_path, "Kp/MaxFeatures=400\n")).values == {"Kp/MaxFeatures": "400"}
    assert read_ini(write(tmp_path, "")).values == {}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[Core]\nRtabmap\\LopThr=0.1", r"rtabmap\.ini:2: neither .* 'Rtabmap/LopThr'; did you mean Rtabmap/LoopThr"),
        ("[Core]\n\nRtabmap\\LoopThr=1.5", r"rtabmap\.ini:3: Rtabmap/LoopThr='1\.5': must be float >= 0 and <= 1"),
        ("Rtabmap/LoopThr=often", r"rtabmap\.ini:1: Rtabmap/LoopThr='often': must be float"),
        ("Rtabmap/LoopThr=nan", r"rtabmap\.ini:1: Rtabmap/LoopThr='nan': must be float"),
        ("Rtabmap/LoopThr 0.1", r"rtabmap\.ini:1: 'Rtabmap/LoopThr 0.1' is not `Group\\Name=value`"),
        ("=3", r"rtabmap\.ini:1: '=3' is not"),
        ("Kp/NndrRatio=0.7\nKp\\NndrRatio=0.8", r"rtabmap\.ini:2: Kp/NndrRatio is given twice"),
        ("zzz=1", r"rtabmap\.ini:1: neither .* 'zzz'; `slamdeck params` lists them all"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        read_ini(write(tmp_path, text))


def test_unreadable_files_are_named(tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match=r"absent\.ini: can't be read \(No such file or directory\)"):
        read_ini(tmp_path / "absent.ini")
    (tmp_path / "image.ini").write_bytes(b"\xff\xd8\xff\xe0")
    with pytest.raises(ParameterError, match=r"image\.ini: can't be read \(it is not text\)"):
        read_ini(tmp_path / "image.ini")


def test_every_name_of_rtabmap_is_either_used_or_known(shared_data: Path) -> None:
    with (shared_data.parent / "ref" / "rtabmap-parameters.csv").open() as table:
        names = [row["name"] for row in csv.DictReader(table)]
    registered = {spec.name for spec in specs()}
    assert len(names) == 527
    assert all(known_unused(name) != (name in registered) for name in names)
    assert not known_unused("Rtabmap/LopThr")


def test_slamdeck_has_no_names_of_its_own() -> None:
    assert known_unused("SURF/Upright")
    assert not any(known_unused(spec.name) for spec in specs())
