"""Batches send what changed and know what was clicked."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from server.scene.batched import PIECE, Batch
from server.scene.shapes import icosphere
from tests.unit.server.scene.conftest import Sent

RED = np.array([200, 40, 40], dtype=np.uint8)
BALL = icosphere(0)


def click(scene: Any, name: str, instance: int | None) -> None:
    """What viser does when a browser says that an instance was clicked."""
    handle = scene.get_handle_by_name(name)
    for entry in handle._impl.click_cb:
        entry.callback(SimpleNamespace(instance_index=instance))


def test_only_what_is_new_is_sent(viewer: Any, sent: Sent) -> None:
    batch, count = Batch(viewer.scene, "/balls", print), PIECE + 5
    places, colours = np.random.default_rng(0).normal(size=(count, 3)), np.tile(RED, (count, 1))
    batch.draw(places, colours, BALL, 0.1)
    sent.take()
    batch.draw(places, colours, BALL, 0.105)
    assert sent.take() == []
    places[-1] += 1.0
    batch.draw(places, colours, BALL, 0.1)
    assert sent.take() == [("update batched_positions", "/balls/1")]
    colours[0] = 255
    batch.draw(places, colours, BALL, 0.1, visible=False)
    hidden = sent.take()
    assert hidden == [("SetSceneNodeVisibility", "/balls/0"), ("SetSceneNodeVisibility", "/balls/1")]
    batch.draw(places, colours, BALL, 0.1)
    assert sent.take() == [*hidden, ("update batched_colors", "/balls/0")]


def test_a_batch_that_grows_or_shrinks_sends_only_the_instances_of_its_last_piece(viewer: Any, sent: Sent) -> None:
    batch, places = Batch(viewer.scene, "/balls", print), np.arange(3.0 * (PIECE + 9)).reshape(-1, 3)
    colours = np.tile(RED, (len(places), 1))
    batch.draw(places[:-5], colours[:-5], BALL, 0.1)
    for count in (PIECE + 9, PIECE + 2):
        sent.take()
        batch.draw(places[:count], colours[:count], BALL, 0.1)
        properties = ("batched_wxyzs", "batched_positions", "batched_colors")
        assert sent.take() == [(f"update {name}", "/balls/1") for name in properties]
        piece = viewer.scene.get_handle_by_name("/balls/1")
        assert len(piece.batched_wxyzs) == len(piece.batched_colors) == count - PIECE
        np.testing.assert_array_equal(piece.batched_positions, places[PIECE:count])
    batch.draw(places[:0], colours[:0], BALL, 0.1)
    assert viewer.scene.get_handle_by_name("/balls/0") is None


def test_another_size_is_sent_to_every_piece(viewer: Any, sent: Sent) -> None:
    batch = Batch(viewer.scene, "/balls", print)
    batch.draw(np.zeros((3, 3)), np.tile(RED, (3, 1)), BALL, 0.1)
    sent.take()
    batch.draw(np.zeros((3, 3)), np.tile(RED, (3, 1)), BALL, 0.2)
    assert ("update vertices", "/balls/0") in sent.take()
    radius = np.linalg.norm(viewer.scene.get_handle_by_name("/balls/0").vertices, axis=1)
    np.testing.assert_allclose(radius, 0.2, rtol=1e-5)


def test_a_click_tells_the_index_over_all_pieces(viewer: Any) -> None:
    clicked: list[int] = []
    batch, count = Batch(viewer.scene, "/balls", clicked.append), PIECE + 5
    batch.draw(np.zeros((count, 3)), np.tile(RED, (count, 1)), BALL, 0.1)
    click(viewer.scene, "/balls/0", 7)
    click(viewer.scene, "/balls/1", 3)
    click(viewer.scene, "/balls/1", None)
    assert clicked == [7, PIECE + 3]
