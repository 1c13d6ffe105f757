"""Graph reduction: a place seen again stays one node, and nothing that hung on the newer one is lost."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from server.browse.loops import loops
from server.browse.snapshot import Snapshot
from slam.database import MapReader, MapWriter
from slam.geometry import between
from slam.graph.graph import PoseGraph
from slam.memory.long_term import RamMemory
from slam.memory.memory import Memory
from slam.memory.past import recall
from slam.memory.tiers import Tiers
from slam.params import Params
from slam.run import ate_rmse_m
from slam.slam import Slam
from slam.trajectory import assemble
from slam.types import WEIGHT_INVALID, LinkType
from tests.ghosts import GhostOdometry, GhostWorld
from tests.nodes import INFORMATION, add_place, at, join, random_descriptors

PLACES, FRAMES = 25, 60


def walked(count: int) -> Tiers:
    params = Params().changed({"Mem/STMSize": 2})
    memory, graph = Memory(RamMemory(), seed=0), PoseGraph()
    for node_id in range(1, count + 1):
        add_place(memory, graph, random_descriptors(3, node_id), params, pose=at(float(node_id)))
    return Tiers(memory, graph)


def test_the_neighbours_are_linked_with_the_older_node() -> None:
    tiers = walked(9)
    loop, step = join(tiers.graph, 6, 2), tiers.graph.links[5, 6]
    tiers.memory.weights |= {2: 3, 6: 1}
    poses = {i: T.copy() for i, T in tiers.graph.poses.items()}
    (done,) = tiers.reduce([6])
    assert (done.node_id, done.into) == (6, 2)
    assert 6 not in tiers.graph
    assert 6 not in tiers.memory.nodes
    assert tiers.memory.weights[2] == 4
    for link in done.links:
        assert link.type is LinkType.NEIGHBOR_MERGED
        assert link.to_id == 2
        assert tiers.graph.links[link.pair] is link
        assert link.T_from_to is not None
        np.testing.assert_allclose(link.T_from_to, between(poses[link.from_id], poses[2]), atol=1e-12)
    assert {link.from_id for link in done.links} == {5, 7}
    # Seen along the way, whose turns the covariances share, both add up.
    sum_of_both = np.linalg.inv(loop.information)[0, 0] + np.linalg.inv(step.information)[0, 0]
    np.testing.assert_allclose(np.linalg.inv(done.links[0].information)[0, 0], sum_of_both, rtol=1e-9)
    np.testing.assert_allclose(done.T_into_node, between(poses[2], poses[6]), atol=1e-12)


def test_the_oldest_of_several_takes_it_in_and_other_loops_stay_loops() -> None:
    tiers = walked(9)
    join(tiers.graph, 7, 4, LinkType.LOCAL_SPACE_CLOSURE)
    join(tiers.graph, 7, 1, LinkType.LOCAL_SPACE_CLOSURE)
    (done,) = tiers.reduce([7])
    assert done.into == 1
    assert {link.pair: link.type for link in done.links} == {
        (1, 6): LinkType.NEIGHBOR_MERGED,
        (1, 8): LinkType.NEIGHBOR_MERGED,
        (1, 4): LinkType.LOCAL_SPACE_CLOSURE,
    }


def test_without_a_loop_to_an_older_node_or_with_a_label_a_node_stays() -> None:
    tiers = walked(9)
    join(tiers.graph, 8, 4)
    tiers.labelled.add(8)
    assert tiers.reduce([4, 5, 8]) == (), "4 is the older one, 5 has no loop, 8 has a label"
    assert len(tiers.graph) == 9


@cache
def lapped(reduce: bool, folder: Path) -> tuple[Slam, Path]:
    """More than two laps of a street of 25 places."""
    world = GhostWorld(PLACES)
    params = Params().changed({"Rtabmap/DetectionRate": 0.0, "Mem/ReduceGraph": reduce})
    path = folder / f"{reduce}.db"
    slam = Slam(params, MapWriter.create(path, params, seed=0, source="ghosts"), source="ghosts")
    slam._odometry = GhostOdometry(world)  # type: ignore[assignment]
    for frame in world.frames(FRAMES):
        slam.process(frame)
    slam.close()
    return slam, path


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("reduced")


def test_a_second_lap_adds_nothing_to_the_map(folder: Path) -> None:
    slam = lapped(True, folder)[0]
    assert len(slam.graph) < PLACES + slam.params.Mem.STMSize + 4
    assert len(lapped(False, folder)[0].graph) == FRAMES
    assert LinkType.NEIGHBOR_MERGED in {link.type for link in slam.graph.links.values()}
    assert len(slam.graph.component(min(slam.graph.poses))) == len(slam.graph)
    assert slam.memory.nodes.keys() == slam.graph.poses.keys()


def test_every_frame_keeps_its_place(folder: Path) -> None:
    slam, path = lapped(True, folder)
    reader = MapReader(path)
    stored = assemble(reader.trajectory(), reader.poses())
    kept = assemble(slam.frames, slam.graph.poses)
    assert len(stored.stamps) == len(kept.stamps) == FRAMES
    np.testing.assert_allclose(stored.T_map_base, kept.T_map_base, atol=1e-4)
    assert stored.node_ids.tolist() == kept.node_ids.tolist()
    error, best = ate_rmse_m(slam), ate_rmse_m(lapped(False, folder)[0])
    assert error is not None
    assert best is not None
    assert error < 1.2 * best + 0.01


def test_the_file_is_a_map_of_what_is_left(folder: Path) -> None:
    slam, path = lapped(True, folder)
    reader = MapReader(path)
    table = reader.nodes()
    gone = {i for i, w in zip(table.ids.tolist(), table.weights.tolist(), strict=True) if w == WEIGHT_INVALID}
    assert set(table.ids.tolist()) - gone == slam.graph.poses.keys()
    assert all(reader.node(i).image_bytes for i in gone), "what was seen stays in the file"
    pointing = [link for link in reader.links() if link.to_id in gone]
    assert pointing == []
    read = PoseGraph.from_reader(reader)
    assert read.links.keys() == slam.graph.links.keys()
    past = recall(reader, slam.params, seed=0)
    assert past.graph.poses.keys() == slam.graph.poses.keys()
    assert past.memory.nodes.keys() == slam.memory.nodes.keys()
    shown = Snapshot(reader, 1, {})
    assert shown.links.keys() == slam.graph.links.keys()
    assert all({row.from_, row.to} <= slam.graph.poses.keys() for row in loops(shown).loops)


def test_the_covariance_of_a_link_over_another_is_in_agreement_from_both_ends() -> None:
    tiers = walked(9)
    tiers.graph.poses[6] = at(6.0, 1.0, 40.0)
    join(tiers.graph, 6, 2)
    (done,) = tiers.reduce([6])
    assert all(np.linalg.eigvalsh(link.information).min() > 0 for link in done.links)
    assert all(np.trace(link.information) < np.trace(INFORMATION) for link in done.links)
