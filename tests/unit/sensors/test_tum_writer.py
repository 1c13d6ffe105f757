"""A source written as a folder and read back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slam.errors import SourceError
from slam.sensors import open_source
from slam.sensors.tum_writer import DEPTH_FACTOR, write_tum_folder


def test_the_folder_holds_what_the_source_gave(folder: Path) -> None:
    written, source = open_source("tour:width=160,height=120"), open_source(folder)
    assert (source.camera.fx, source.camera.cx) == (written.camera.fx, written.camera.cx)
    for frame, back in zip(written, source, strict=False):
        assert back.stamp == pytest.approx(frame.stamp, abs=1e-6)
        assert np.abs(back.depth_m - frame.depth_m).max() <= 0.51 / DEPTH_FACTOR
        assert np.abs(back.image_bgr.astype(int) - frame.image_bgr).mean() < 4.0
        assert frame.T_world_base is not None
        assert frame.T_gravity_base is not None
        assert back.T_world_base is not None
        assert back.T_gravity_base is not None
        assert np.allclose(back.T_world_base, frame.T_world_base, atol=1e-6)
        assert np.degrees(np.arccos(back.T_gravity_base[2, :3] @ frame.T_gravity_base[2, :3])) < 2.0


def test_existing_folders_are_left_alone(folder: Path) -> None:
    with pytest.raises(SourceError, match="exists already; name a folder that is new or empty"):
        write_tum_folder(open_source("tour:width=64,height=48"), folder, 1)


def test_a_place_that_cannot_be_written_is_named(folder: Path) -> None:
    with pytest.raises(SourceError, match=r"can't be written \(Not a directory\)"):
        write_tum_folder(open_source("tour:width=64,height=48"), folder / "rgb.txt" / "deeper", 1)
