"""Several maps as one."""

from __future__ import annotations

from pathlib import Path

import pytest

from slam.database import MapReader, MapWriter
from slam.errors import DatabaseError
from slam.slam import Slam
from slam.tools.merge import merge
from slam.tools.reprocess import Request
from tests.tours import EVERY, fed, saved, sparse


def far_away(folder: Path) -> Path:
    """A map of the far side of the room."""
    path = folder / "far.db"
    slam = Slam(EVERY, MapWriter.create(path, EVERY, seed=0, source="far"), source="far")
    fed(slam, sparse()[40:48])
    slam.close()
    return path


def test_maps_of_the_same_place_are_joined_and_others_say_why_not(tmp_path: Path) -> None:
    again = tmp_path / "again.db"
    again.write_bytes(saved(0).read_bytes())
    inputs = [saved(0), again, far_away(tmp_path)]
    summary = merge(Request(inputs=inputs, output=tmp_path / "all.db"))
    first, second, third = summary["pairs"]
    assert first["files"] == ["map.db", "again.db"] and first["joined"] and first["links"]
    links = {link.pair for link in MapReader(tmp_path / "all.db").links()}
    assert {(min(pair), max(pair)) for pair in first["links"]} <= links
    assert all(max(pair) > 18 >= min(pair) for pair in first["links"])
    for pair in (second, third):
        assert pair["files"][1] == "far.db" and not pair["joined"] and pair["links"] == []
        assert pair["best"]["text"] and pair["best"]["test"]
    assert summary["sessions"] == [[0], [1], [2]]


def test_one_map_is_not_merged(tmp_path: Path) -> None:
    with pytest.raises(DatabaseError, match="needs two or more"):
        merge(Request(inputs=[saved(0)], output=tmp_path / "all.db"))
