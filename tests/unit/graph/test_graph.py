"""The pose graph as a container: what goes in, what walks along it, what is refused."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from slam.errors import OptimizationError
from slam.geometry import Pose, inverse
from slam.graph import PoseGraph
from slam.types import Link, LinkType
from tests.graphs import INFORMATION, circles


def link(a: int, b: int, kind: LinkType = LinkType.NEIGHBOR) -> Link:
    return Link(a, b, kind, np.eye(4), INFORMATION)


def chain(nodes: int) -> PoseGraph:
    return circles(nodes, loops=0)


def test_neighbors_are_seen_from_both_ends_and_cannot_be_changed() -> None:
    graph = chain(3)
    assert set(graph.neighbors(2)) == {1, 3}
    assert graph.neighbors(1)[2] is graph.neighbors(2)[1]
    with pytest.raises(TypeError):
        graph.neighbors(1)[3] = link(1, 3)  # type: ignore[index]


def test_removing_what_was_added_leaves_the_graph_as_it_was() -> None:
    graph = chain(4)
    links, neighbors = dict(graph.links), {i: dict(graph.neighbors(i)) for i in graph.poses}
    added = link(4, 1, LinkType.GLOBAL_CLOSURE)
    graph.add_link(added)
    assert graph.remove_link((1, 4)) is added
    assert graph.links == links
    assert {i: dict(graph.neighbors(i)) for i in graph.poses} == neighbors


def test_removing_a_node_takes_its_links_along() -> None:
    graph = chain(3)
    graph.remove_node(2)
    assert not graph.links
    assert list(graph.poses) == [1, 3]
    assert not graph.neighbors(1)


def test_distance_counts_links_and_takes_short_cuts() -> None:
    graph = chain(10)
    assert graph.within(1, 3) == {1: 0, 2: 1, 3: 2, 4: 3}
    graph.add_link(link(10, 1, LinkType.GLOBAL_CLOSURE))
    assert graph.within(1, 2) == {1: 0, 2: 1, 10: 1, 3: 2, 9: 2}


def test_a_way_has_the_fewest_links() -> None:
    graph = chain(6)
    assert graph.way(2, 6) == [2, 3, 4, 5, 6]
    graph.add_link(link(6, 3, LinkType.GLOBAL_CLOSURE))
    assert graph.way(2, 6) == [2, 3, 6]
    assert graph.way(4, 4) == [4]
    graph.add_node(9, 0, np.eye(4), np.eye(4))
    assert graph.way(2, 9) == graph.way(9, 2) == graph.way(2, 77) == []


def test_follow_makes_loops_free_and_proximity_links_walls() -> None:
    graph = chain(10)
    graph.add_link(link(8, 1, LinkType.GLOBAL_CLOSURE))
    graph.add_link(link(5, 1, LinkType.LOCAL_SPACE_CLOSURE))

    def follow(at: Link) -> int | None:
        return {LinkType.GLOBAL_CLOSURE: 0, LinkType.LOCAL_SPACE_CLOSURE: None}.get(at.type, 1)

    assert graph.within(1, 1, follow) == {1: 0, 8: 0, 2: 1, 7: 1, 9: 1}


def test_a_component_ends_where_links_end() -> None:
    graph = chain(5)
    graph.remove_link((2, 3))
    assert graph.component(1) == {1, 2}
    assert graph.component(4) == {3, 4, 5}


def test_correction_takes_odometry_into_the_map() -> None:
    graph = chain(5)
    T_map_odom = circles(3, 0).poses[3]
    graph.poses = {i: T_map_odom @ T for i, T in graph.T_odom.items()}
    assert np.allclose(graph.correction, T_map_odom)


@pytest.mark.parametrize(
    ("bad", "says"),
    [
        (link(1, 9), "node 9 is not in the graph"),
        (link(2, 1), "joined by a Neighbor"),
        (link(1, 1), "two nodes and a transform"),
        (replace(link(1, 3), T_from_to=None), "two nodes and a transform"),
    ],
)
def test_links_that_do_not_fit_are_refused_and_leave_no_trace(bad: Link, says: str) -> None:
    graph = chain(3)
    with pytest.raises(OptimizationError, match=says):
        graph.add_link(bad)
    assert set(graph.links) == {(1, 2), (2, 3)}
    assert set(graph.neighbors(1)) == {2}


def test_unknown_ids_are_named() -> None:
    graph = chain(2)
    with pytest.raises(OptimizationError, match="node 7"):
        graph.neighbors(7)
    with pytest.raises(OptimizationError, match="1 and 7 are not linked"):
        graph.remove_link((1, 7))
    with pytest.raises(OptimizationError, match="node 2 is in the graph already"):
        graph.add_node(2, 0, np.eye(4), np.eye(4))
    with pytest.raises(OptimizationError, match="no node"):
        _ = PoseGraph().newest


@dataclass
class Columns:
    ids: list[int]
    map_ids: list[int]
    weights: list[int]
    T_odom: list[Pose]


@dataclass
class Reader:
    columns: Columns
    stored_links: list[Link]
    stored_poses: dict[int, Pose] = field(default_factory=dict)

    def nodes(self) -> Columns:
        return self.columns

    def links(self) -> list[Link]:
        return self.stored_links

    def poses(self) -> dict[int, Pose]:
        return self.stored_poses


def test_from_reader_keeps_poses_and_leaves_out_what_has_no_place_in_the_graph() -> None:
    source = circles(4, 0)
    T_odom = [*(source.T_odom[i] for i in range(1, 5)), np.full((4, 4), np.nan), np.eye(4)]
    prior = Link(1, 1, LinkType.POSE_PRIOR, np.eye(4), INFORMATION)
    landmark = Link(2, -7, LinkType.LANDMARK, np.eye(4), INFORMATION)
    merged = Link(4, 3, LinkType.NEIGHBOR_MERGED, None, INFORMATION)
    T_map_odom = inverse(T_odom[2])
    poses = {i: T_map_odom @ T for i, T in zip((1, 2, 3), T_odom, strict=False)}
    columns = Columns([1, 2, 3, 4, 5, 6], [0, 0, 1, 1, 1, 1], [0, 3, -1, 0, 0, -9], T_odom)
    graph = PoseGraph.from_reader(Reader(columns, [link(1, 2), prior, landmark, merged, link(4, 6)], poses))
    assert set(graph.links) == {(1, 2)}
    assert list(graph.constraints.values()) == [prior, landmark]
    assert graph.map_ids == {1: 0, 2: 0, 3: 1, 4: 1}
    assert np.array_equal(graph.poses[2], poses[2])
    assert np.array_equal(graph.poses[4], T_odom[3])
