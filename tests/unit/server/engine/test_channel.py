"""The engine's end of the channel: requests in order, and a server that is gone is a request to stop."""

from __future__ import annotations

import multiprocessing
from collections.abc import Iterator
from multiprocessing.connection import Connection
from typing import Any

import pytest

from server.engine.channel import Channel
from server.engine.commands import Pause, Request, Resume, Stop
from server.engine.events import Answer, GraphChanged
from slam.errors import DecisionError

Ends = tuple[Channel, "Connection[Any, Any]"]


@pytest.fixture
def ends() -> Iterator[Ends]:
    ours, theirs = multiprocessing.get_context("spawn").Pipe()
    yield Channel(theirs), ours
    ours.close()


def test_requests_come_in_order_and_answers_go_back(ends: Ends) -> None:
    channel, server = ends
    server.send(Request(1, Pause()))
    server.send(Request(2, Resume()))
    first, second = channel.next(5), channel.next(5)
    assert first == Request(1, Pause()) and second == Request(2, Resume())
    channel.answer(first, "done")
    channel.refuse(second, DecisionError("no"))
    channel.send(GraphChanged())
    answered, refused = server.recv(), server.recv()
    assert answered == Answer(1, "done")
    assert isinstance(refused.error, DecisionError) and str(refused.error) == "no"
    assert server.recv() == GraphChanged()


def test_no_request_is_none(ends: Ends) -> None:
    assert ends[0].next(0) is None
    assert ends[0].next(0.01) is None


def test_a_server_that_died_asks_to_stop_and_is_told_nothing(ends: Ends) -> None:
    channel, server = ends
    server.close()
    assert channel.next(5) == Request(0, Stop())
    channel.send(GraphChanged())
