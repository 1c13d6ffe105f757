"""Every browser gets the newest value of each key, and a slow one costs no more than that."""

from __future__ import annotations

import asyncio
import json
import threading
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from server.hub import Hub, Mailbox

KEYS = st.sampled_from([("session", None), ("update", "a"), ("update", "b"), ("graph", "a")])


async def drain(box: Mailbox) -> list[Any]:
    taken = []
    while True:
        try:
            taken.append(json.loads(await asyncio.wait_for(box.take(), 0.02)))
        except TimeoutError:
            return taken


@given(st.lists(st.tuples(KEYS, st.integers()), max_size=30))
def test_who_comes_late_gets_the_last_value_of_each_key(published: list[tuple[tuple[str, str | None], int]]) -> None:
    hub = Hub()
    for (topic, map_id), value in published:
        hub.publish(topic, map_id, value)
    with hub.mailbox() as box:
        taken = asyncio.run(drain(box))
    assert {(m["topic"], m["map"]): m["value"] for m in taken} == dict(published)
    assert len(taken) == len(dict(published))


def test_moments_are_for_those_who_are_there() -> None:
    hub = Hub()
    with hub.mailbox() as there:
        hub.publish("selection", "a", 1)
    with hub.mailbox() as late:
        assert asyncio.run(drain(late)) == []
    assert asyncio.run(drain(there)) == [], "without a loop nobody is served yet"


def test_a_slow_browser_skips_values_and_gets_the_newest() -> None:
    async def scenario() -> list[Any]:
        hub = Hub()
        hub.attach(asyncio.get_running_loop())
        with hub.mailbox() as box:
            for value in range(1000):
                hub.publish("update", "a", value)
            hub.publish("session", None, "x")
            await asyncio.sleep(0)
            return await drain(box)

    assert [m["value"] for m in asyncio.run(scenario())] == [999, "x"]


def test_any_thread_may_publish_and_nothing_is_lost_for_a_quick_browser() -> None:
    async def scenario() -> list[Any]:
        hub = Hub()
        hub.attach(asyncio.get_running_loop())
        with hub.mailbox() as box:
            threads = [threading.Thread(target=hub.publish, args=("update", str(k), k)) for k in range(20)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            return await drain(box)

    assert sorted(m["value"] for m in asyncio.run(scenario())) == list(range(20))
