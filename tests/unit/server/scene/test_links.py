"""Links are drawn by kind, loops as arcs that can be clicked."""

from __future__ import annotations

from typing import Any

import numpy as np

from server.browse.snapshot import Pair, Snapshot
from server.scene.colours import DARK, LIGHT
from server.scene.links import LinkLayer, arc, colour, segments
from server.scene.placed import LinkKind, PlacedGraph
from tests.unit.server.scene.conftest import Sent
from tests.unit.server.scene.room_map import LOOPS, NODES, REFUSED
from tests.unit.server.scene.test_batched import click


def test_an_arc_joins_its_ends_and_rises_between_them_even_when_they_are_one() -> None:
    ends = np.array([[[0.0, 0, 0], [4.0, 0, 1]], [[2.0, 2, 0], [2.0, 2, 0]]])
    paths = arc(ends, 0.1, 8)
    np.testing.assert_allclose(paths[:, [0, -1]], ends)
    assert (paths[:, 4, 2] > ends[:, :, 2].mean(axis=1) + 0.2).all()
    assert segments(paths).shape == (16, 2, 3)


def test_every_kind_of_link_has_a_colour_of_its_own() -> None:
    for look in (DARK, LIGHT):
        assert len({colour(kind, look) for kind in LinkKind}) == len(LinkKind)


def test_every_link_is_drawn_and_refused_loops_have_gaps(viewer: Any, snapshot: Snapshot) -> None:
    graph = PlacedGraph.of(snapshot)
    LinkLayer(viewer.scene, print).draw(graph, 0.05, DARK, visible=True)
    drawn = {kind: viewer.scene.get_handle_by_name(f"/graph/{kind.value}/0") for kind in LinkKind}
    assert len(drawn[LinkKind.NEIGHBOR].points) == NODES - 1
    assert drawn[LinkKind.VIRTUAL] is None
    joined = drawn[LinkKind.LOOP].points
    np.testing.assert_array_equal(joined[:-1, 1], joined[1:, 0])
    dashes = drawn[LinkKind.REFUSED].points
    assert (np.linalg.norm(dashes[:-1, 1] - dashes[1:, 0], axis=1) > 0).all()


def test_a_clicked_knot_names_the_link(viewer: Any, snapshot: Snapshot) -> None:
    clicked: list[Pair] = []
    LinkLayer(viewer.scene, clicked.append).draw(PlacedGraph.of(snapshot), 0.05, DARK, visible=True)
    for kind in (LinkKind.LOOP, LinkKind.PROXIMITY, LinkKind.USER, LinkKind.REFUSED):
        click(viewer.scene, f"/graph/knots/{kind.value}/0", 0)
        click(viewer.scene, f"/graph/knots/{kind.value}/0", 99)
    assert [set(pair) for pair in clicked] == [{new, old} for new, (old, _) in LOOPS.items()] + [set(REFUSED)]


def test_hiding_sends_no_points(viewer: Any, snapshot: Snapshot, sent: Sent) -> None:
    layer, graph = LinkLayer(viewer.scene, print), PlacedGraph.of(snapshot)
    layer.draw(graph, 0.05, DARK, visible=True)
    sent.take()
    layer.draw(graph, 0.05, DARK, visible=False)
    assert {kind for kind, _ in sent.take()} == {"SetSceneNodeVisibility"}
