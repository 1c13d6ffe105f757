"""Copies of maps with fewer nodes."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from itertools import pairwise
from pathlib import Path
from shutil import copyfile

import numpy as np
import pytest

from slam.database import JournalEntry, MapReader, MapWriter
from slam.errors import DatabaseError
from slam.geometry import between
from slam.tools.describe import describe
from slam.tools.thin import Thinning, thin
from slam.types import Link, LinkType
from tests.tours import saved

KEYS = {"Node": "id", "Data": "id", "Feature": "node_id", "Statistics": "id", "deck_update": "id"}


def rows(path: Path, table: str, ids: list[int] | None = None) -> list[tuple[object, ...]]:
    with closing(sqlite3.connect(path)) as connection:
        found = connection.execute(f"SELECT * FROM {table} ORDER BY rowid").fetchall()
        names = [row[1] for row in connection.execute(f"PRAGMA table_info({table})")]
    at = names.index(KEYS[table]) if ids is not None else 0
    return found if ids is None else [row for row in found if row[at] in set(ids)]


@pytest.fixture
def judged(tmp_path: Path) -> Path:
    """A map of 18 nodes a half second apart, with a link by hand from 15 to 4 and a label on 8."""
    path = tmp_path / "judged.db"
    copyfile(saved(0), path)
    poses = MapReader(path).poses()
    link = Link(15, 4, LinkType.USER_CLOSURE, between(poses[15], poses[4]), np.eye(6))
    with MapWriter.open(path) as writer:
        writer.append_decision(
            JournalEntry(action="add", from_id=15, to_id=4, author="Ada", link_after=link), add=[link], poses=poses
        )
        writer.label_nodes({8: "door"})
    return path


def test_what_is_kept_is_equal_and_the_gaps_are_bridged(judged: Path, tmp_path: Path) -> None:
    told = thin(judged, tmp_path / "thin.db", Thinning(rate=0.5))
    new, old = MapReader(tmp_path / "thin.db"), MapReader(judged)
    ids = new.node_ids().tolist()
    assert ids == [1, 4, 5, 8, 9, 13, 15, 17] and (told.nodes, told.of, told.bridges) == (8, 18, 5)
    for table in KEYS:
        assert rows(tmp_path / "thin.db", table) == rows(judged, table, ids), table
    assert rows(tmp_path / "thin.db", "deck_journal") == rows(judged, "deck_journal")
    assert rows(tmp_path / "thin.db", "Info") == rows(judged, "Info")
    T_odom = dict(zip(ids, new.nodes().T_odom, strict=True))
    links = {link.pair: link for link in new.links()}
    chain = {link.pair: link for link in old.links() if link.type is LinkType.NEIGHBOR}
    for older, newer in pairwise(ids):
        link = links[older, newer]
        np.testing.assert_allclose(link.T_from_to, between(T_odom[newer], T_odom[older]), atol=1e-6)
        parts = [np.linalg.inv(chain[k, k + 1].information) for k in range(older, newer)]
        np.testing.assert_allclose(np.linalg.inv(link.information), sum(parts), rtol=1e-6, atol=1e-12)
    assert links[4, 15].type is LinkType.USER_CLOSURE and new.journal()[0].author == "Ada"
    assert {i: T.tolist() for i, T in new.poses().items()} == {i: old.poses()[i].tolist() for i in ids}
    assert describe(new).missing == () and new.grid() is not None


def test_without_images_all_else_stays(judged: Path, tmp_path: Path) -> None:
    thin(judged, tmp_path / "thin.db", Thinning(images=False))
    new = MapReader(tmp_path / "thin.db")
    assert len(new.nodes()) == 18 and not len(new.nodes_with("image")) and not len(new.nodes_with("depth"))
    for table in ("Node", "Feature", "Statistics", "deck_update", "deck_journal", "Link", "Admin"):
        assert rows(tmp_path / "thin.db", table) == rows(judged, table), table
    assert (tmp_path / "thin.db").stat().st_size < 0.5 * judged.stat().st_size


def test_sessions_and_spans_of_time(judged: Path, tmp_path: Path) -> None:
    thin(judged, tmp_path / "part.db", Thinning(sessions=(0,), start=2.0, end=4.0))
    assert MapReader(tmp_path / "part.db").node_ids().tolist() == [5, 6, 7, 8, 9]
    with pytest.raises(DatabaseError, match="there is no session 3; it has 0"):
        thin(judged, tmp_path / "none.db", Thinning(sessions=(3,)))
    with pytest.raises(DatabaseError, match="none would be left"):
        thin(judged, tmp_path / "none.db", Thinning(start=100.0))


def test_files_of_rtabmap(shared_data: Path, tmp_path: Path) -> None:
    source = shared_data / "rtabmap_db" / "cpp_0.23.8_tum_fr1_xyz_excerpt.db"
    told = thin(source, tmp_path / "thin.db", Thinning(rate=1.0))
    assert told.nodes < told.of == 29 and describe(MapReader(tmp_path / "thin.db")).missing == ()
    ids = MapReader(tmp_path / "thin.db").node_ids().tolist()
    for table in ("Node", "Data", "Feature", "Statistics"):
        assert rows(tmp_path / "thin.db", table) == rows(source, table, ids), table
