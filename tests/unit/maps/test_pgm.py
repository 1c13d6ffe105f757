"""Grids as map_server reads them."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

from slam.errors import DatabaseError
from slam.maps.pgm import write_pgm
from slam.types import OccupancyGrid

GRID = OccupancyGrid(np.array([[0, 100, -1], [-1, 0, 0]], dtype=np.int8), -1.25, 3.5, 0.05)


def test_the_top_row_of_the_image_is_the_largest_y(tmp_path: Path) -> None:
    write_pgm(tmp_path / "map.pgm", GRID)
    image = cv2.imread(str(tmp_path / "map.pgm"), cv2.IMREAD_UNCHANGED)
    assert np.array_equal(image, [[205, 254, 254], [254, 0, 205]])


def test_the_yaml_says_where_and_how_fine(tmp_path: Path) -> None:
    said = yaml.safe_load(write_pgm(tmp_path / "map.pgm", GRID).read_text())
    assert said["image"] == "map.pgm"
    assert said["resolution"] == 0.05
    assert said["origin"] == [-1.25, 3.5, 0.0]
    # map_server: p = (255 - shade) / 255; unknown lies between the thresholds.
    shades = {0: 1.0, 254: 1 / 255, 205: 50 / 255}
    assert shades[0] > said["occupied_thresh"]
    assert shades[254] < said["free_thresh"]
    assert said["free_thresh"] < shades[205] < said["occupied_thresh"]


def test_a_missing_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(DatabaseError, match=r"nowhere.*can't be written"):
        write_pgm(tmp_path / "nowhere" / "map.pgm", GRID)
