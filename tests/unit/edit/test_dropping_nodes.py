"""Nodes that leave the map: neighbours keep their relative pose, undo brings everything back to the last bit."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from slam.database import MapReader, MapWriter
from slam.edit.nodes import bridged, dropping, labelling
from slam.errors import DecisionError
from slam.geometry import between
from slam.graph import PoseGraph, optimize
from slam.params import Params
from slam.review import Review
from slam.types import LinkType
from tests.graphs import INFORMATION, circles, stacked, write_map

PARAMS = Params()
NODES = 45


@pytest.fixture
def opened(tmp_path: Path) -> Iterator[tuple[Review, MapReader]]:
    graph = circles(NODES, loops=3)
    graph.poses = optimize(graph, PARAMS).poses
    path = write_map(tmp_path / "map.db", graph)
    with MapWriter.open(path) as writer:
        reader = MapReader(path)
        yield Review(PoseGraph.from_reader(reader), writer, reader, PARAMS), reader


def same_file(review: Review, reader: MapReader) -> None:
    """The graph in RAM is the one in the file."""
    stored = PoseGraph.from_reader(reader)
    assert stored.links.keys() == review.graph.links.keys()
    assert stored.poses.keys() == review.graph.poses.keys()
    assert np.allclose(stacked(stored.poses), stacked(review.graph.poses), atol=1e-6)


@pytest.mark.parametrize("gone", [[3], [3, 4, 5], [4, 6], [1], [NODES]])
def test_a_bridge_is_the_way_over_the_gap(gone: list[int]) -> None:
    graph = circles(8, loops=0, noise=0.0)
    links = bridged(graph, gone)
    for (old, new), link in links.items():
        assert link.type is LinkType.NEIGHBOR_MERGED
        assert link.T_from_to is not None
        assert np.allclose(link.T_from_to, between(graph.poses[new], graph.poses[old]), atol=1e-9)
        steps = new - old
        smallest = np.linalg.eigvalsh(np.linalg.inv(link.information))[0]
        assert smallest > 0.9 * steps * np.linalg.eigvalsh(np.linalg.inv(INFORMATION))[0], "covariances add up"
    inside = [node_id for node_id in gone if 1 < node_id < 8]
    assert bool(links) == bool(inside)


def test_dropping_keeps_the_neighbours_where_they_are_to_each_other_and_undo_brings_all_back(
    opened: tuple[Review, MapReader],
) -> None:
    review, reader = opened
    links, poses = dict(review.graph.links), dict(review.graph.poses)
    before = between(poses[9], poses[13])
    done = review.change(dropping(review.graph, reader, [10, 11, 12], "ann"))
    assert {10, 11, 12}.isdisjoint(review.graph.poses)
    assert done.separated == 0
    # Within one sigma of a step.
    assert np.allclose(between(review.graph.poses[9], review.graph.poses[13]), before, atol=0.01)
    same_file(review, reader)
    assert reader.info().nodes == NODES - 3 and reader.info().dropped == 3
    batch = {entry.batch for entry in reader.journal()}
    assert len(batch) == 1 and None not in batch
    review.undo("ann")
    assert review.graph.links.keys() == links.keys()
    assert np.array_equal(stacked(review.graph.poses), stacked(poses)), "to the last bit"
    same_file(review, reader)
    assert reader.info().dropped == 0
    review.redo("ann")
    same_file(review, reader)
    assert reader.info().dropped == 3


def test_undo_works_after_a_restart(opened: tuple[Review, MapReader]) -> None:
    review, reader = opened
    before = dict(review.graph.poses)
    review.change(dropping(review.graph, reader, [20], ""))
    again = Review(PoseGraph.from_reader(reader), review._writer, reader, PARAMS)
    again.undo()
    assert 20 in again.graph.poses
    assert np.allclose(stacked(again.graph.poses), stacked(before), atol=1e-3)
    same_file(again, reader)


def test_a_preview_changes_nothing_and_says_who_is_cut_off(opened: tuple[Review, MapReader]) -> None:
    review, reader = opened
    poses = review.graph.poses
    ends = dropping(review.graph, reader, [NODES], "")
    assert review.change(ends, preview=True).separated == 0
    entries = [e for e in dropping(review.graph, reader, list(range(3, 40)), "") if e.action != "bridge"]
    assert review.change(entries, preview=True).separated > 0
    assert review.graph.poses is poses
    assert not reader.journal()


def test_what_makes_no_sense_is_refused(opened: tuple[Review, MapReader]) -> None:
    review, reader = opened
    with pytest.raises(DecisionError, match="node 99 is not"):
        dropping(review.graph, reader, [99], "")
    with pytest.raises(DecisionError, match="none would be left"):
        dropping(review.graph, reader, list(review.graph.poses), "")


def test_labels_are_given_once_changed_taken_away_and_undone(opened: tuple[Review, MapReader]) -> None:
    review, reader = opened

    def label(node_id: int, text: str) -> None:
        review.change(labelling(review.graph, reader, [node_id], text, "ann"))

    def stored(node_id: int) -> str:
        return reader.node(node_id).label or ""

    label(5, " kitchen ")
    assert stored(5) == "kitchen"
    with pytest.raises(DecisionError, match="node 5 has it"):
        label(6, "kitchen")
    with pytest.raises(DecisionError, match="already"):
        label(5, "kitchen")
    label(5, "bath")
    label(6, "kitchen")
    label(5, "")
    assert (stored(5), stored(6)) == ("", "kitchen")
    with pytest.raises(DecisionError, match="no label"):
        label(5, "")
    review.undo()
    assert stored(5) == "bath"
    review.undo()
    review.undo()
    assert (stored(5), stored(6)) == ("kitchen", "")
    review.redo()
    assert stored(5) == "bath"
