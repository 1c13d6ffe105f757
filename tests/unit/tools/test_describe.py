"""What is said of map files at a second look."""

from __future__ import annotations

import sqlite3
from pathlib import Path
from shutil import copyfile

import numpy as np
import pytest

from slam.database import MapReader
from slam.tools.describe import describe
from tests.tours import saved


@pytest.fixture
def damaged(tmp_path: Path) -> Path:
    path = tmp_path / "damaged.db"
    copyfile(saved(0), path)
    with sqlite3.connect(path) as connection:
        connection.executescript(
            "DELETE FROM Link WHERE from_id = 3 AND to_id = 4;"
            "DELETE FROM Node WHERE id = 9;"
            "DELETE FROM Word WHERE id IN (SELECT max(word_id) FROM Feature WHERE node_id = 1);"
            "UPDATE Data SET calibration = NULL WHERE id = 2;"
        )
    return path


def test_a_sound_map_lacks_nothing() -> None:
    told = describe(MapReader(saved(0)))
    assert told.missing == () and told.labels == {"map0": 1} and told.with_truth == told.with_images == 18
    truth = MapReader(saved(0)).nodes().T_world[:, :3, 3]
    length = np.linalg.norm(np.diff(truth, axis=0), axis=1).sum()
    assert told.map_m == pytest.approx(length, rel=0.05) and told.odometry_m == pytest.approx(length, rel=0.05)
    assert told.span_s == pytest.approx(8.5) and sum(told.weights.values()) == 18


def test_what_is_missing_is_named(damaged: Path) -> None:
    text = "\n".join(describe(MapReader(damaged)).missing)
    assert "1 links without their reverse: 4-3" in text
    assert "links with a node that is not there: 8-9, 9-8, 9-9, 9-10, 10-9" in text
    assert "1 words that key points have and the dictionary has not" in text
    assert "1 nodes that are not there and have key points: 9" in text
    assert "1 nodes that are not there and have data: 9" in text
    assert "1 nodes without a calibration: 2" in text


def test_a_file_that_rtabmap_left_uncleanly(shared_data: Path) -> None:
    path = next((shared_data / "rtabmap_db").glob("Strroke21*.db"))
    told = describe(MapReader(path))
    assert told.missing[0] == "the last session was not closed in order"
    assert "49 links without their reverse: 69-1, 70-69" in told.missing[1]
    assert told.weights == {"seen once": 50, "seen again": 0, "intermediate": 0, "dropped": 361}
