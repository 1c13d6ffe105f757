"""Intermediate nodes: poses on the path between two places, which memory and loops pass over."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from slam.database import MapReader, MapWriter
from slam.graph.graph import PoseGraph
from slam.loop.transition import Transition
from slam.memory.past import recall
from slam.params import Params
from slam.run import ate_rmse_m
from slam.slam import Slam
from slam.types import WEIGHT_INTERMEDIATE, LinkType, Tier, Update
from tests.ghosts import GhostOdometry, GhostWorld, visited
from tests.nodes import chain

#: The frames come at 2 Hz: every second one is between two updates.
PLACES, FRAMES = 50, 116
BETWEEN = Params().changed({"Rtabmap/DetectionRate": 1.0, "Rtabmap/CreateIntermediateNodes": True})


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("between")


@cache
def lapped(folder: Path, room: int = 0, kept: bool = False, count: int = FRAMES) -> tuple[Slam, list[Update], Path]:
    world = GhostWorld(PLACES)
    params = BETWEEN.changed({"Rtabmap/MemoryThr": room, "Mem/IntermediateNodeDataKept": kept})
    path = folder / f"{room}-{kept}.db"
    slam = Slam(params, MapWriter.create(path, params, seed=0, source="ghosts"), source="ghosts")
    slam._odometry = GhostOdometry(world)  # type: ignore[assignment]
    updates = [slam.process(frame) for frame in world.frames(count)]
    slam.close()
    return slam, updates, path


def test_every_second_frame_is_an_intermediate_node_on_the_path(folder: Path) -> None:
    slam, _, path = lapped(folder)
    table = MapReader(path).nodes()
    assert table.weights[1::2].tolist() == [WEIGHT_INTERMEDIATE] * (FRAMES // 2)
    assert (table.weights[::2] >= 0).all()
    for node_id in range(1, FRAMES):
        assert slam.graph.links[node_id, node_id + 1].type is LinkType.NEIGHBOR
    assert [frame.node_id for frame in slam.frames] == list(range(1, FRAMES + 1))


def test_they_are_no_places(folder: Path) -> None:
    slam, updates, _ = lapped(folder)
    between = slam.graph.between
    assert len(slam.memory.stm) == slam.params.Mem.STMSize
    assert not between & {*slam.memory.stm, *slam.memory.wm, *slam.memory.nodes}
    loops = [c for update in updates for c in update.candidates]
    assert any(c.refusal is None for c in loops)
    assert not between & {i for c in loops for i in (c.from_id, c.to_id)}
    last = updates[-1].statistics
    assert last["Memory/Short_time_memory_inter_size/"] == slam.params.Mem.STMSize
    assert last["Memory/Working_memory_inter_size/"] == last["Memory/Working_memory_size/"]


def test_belief_passes_over_them() -> None:
    params = Params()
    plain = chain(12)
    over = chain(23)
    over.between |= set(range(2, 23, 2))
    np.testing.assert_array_equal(
        Transition().update(list(range(1, 24, 2)), over, params), Transition().update(list(range(1, 13)), plain, params)
    )
    assert {i for i in over.within(11, 2) if i % 2} == {7, 9, 11, 13, 15}
    assert dict(over.places_beside(11)).keys() == {9, 13}


def test_they_go_and_come_back_with_the_place_that_they_follow(folder: Path) -> None:
    slam, updates, _ = lapped(folder, room=12)
    assert slam.memory.ltm
    assert any(update.statistics["Memory/Signatures_retrieved/"] for update in updates)
    tiers: dict[int, Tier] = {}
    for update in updates:
        tiers |= update.tiers
        in_ram = {i for i, tier in tiers.items() if tier is not Tier.LTM}
        assert update.node is not None
        together = slam.memory.with_between(i for i in sorted(in_ram) if i % 2)
        assert in_ram == {i for i in together if i <= update.node.id}
    assert set(slam.memory.with_between([*slam.memory.stm, *slam.memory.wm])) == set(slam._active.graph.poses)
    assert len(slam.graph) == FRAMES


def test_the_path_is_as_good_as_without(folder: Path) -> None:
    error = ate_rmse_m(lapped(folder)[0])
    assert error is not None
    assert error < 0.05


@pytest.mark.parametrize("kept", [False, True])
def test_their_images_are_stored_where_asked_for(folder: Path, kept: bool) -> None:
    reader = MapReader((lapped(folder, kept=True, count=6) if kept else lapped(folder))[2])
    assert bool(reader.node(2).image_bytes) == kept
    assert reader.node(3).image_bytes
    assert reader.node(2).features == 0


def test_a_session_goes_on_with_them(folder: Path) -> None:
    slam, _, path = lapped(folder, room=12)
    past = recall(MapReader(path), slam.params, seed=0)
    assert past.graph.between == slam.graph.between
    assert past.memory.between == slam.memory.between
    assert past.memory.weights == slam.memory.weights
    assert set(past.memory.in_ram()) == set(slam.memory.in_ram())
    assert PoseGraph.from_reader(MapReader(path)).between == slam.graph.between


def test_back_at_the_last_place_a_frame_is_one_more_of_them() -> None:
    slam, updates = visited([5, 6, 5], BETWEEN)
    assert [None if u.node is None else u.weight for u in updates] == [0, -1, -1]
    assert slam.memory.weights == {1: 1, 2: -1, 3: -1}, "the place weighs more"
    slam, updates = visited([5, 5, 5], BETWEEN)
    assert [u.node is not None for u in updates] == [True, False, False], "a robot that stands makes none"
    assert slam.memory.weights == {1: 1}
