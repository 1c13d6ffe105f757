"""Fan-out of changes to all browsers, with the last value of each key for those that come later."""

from __future__ import annotations

import asyncio
import json
from collections import OrderedDict
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

Key = tuple[str, str | None]

#: Topics that tell of a moment: whoever was not there then does not get them.
_MOMENTS = frozenset({"selection", "decision", "weights", "trial"})


class Mailbox:
    """What one browser has not got yet: at most one message for each key, the newest."""

    def __init__(self) -> None:
        self._waiting: OrderedDict[Key, str] = OrderedDict()
        self._filled = asyncio.Event()

    def put(self, key: Key, text: str) -> None:
        """Add a message; an older one of the same key that still waits is dropped."""
        self._waiting.pop(key, None)
        self._waiting[key] = text
        self._filled.set()

    async def take(self) -> str:
        """The message that has waited longest."""
        while not self._waiting:
            self._filled.clear()
            await self._filled.wait()
        return self._waiting.popitem(last=False)[1]


class Hub:
    """Takes messages from any thread and hands them to every mailbox.

    The keys are few (topics times maps), so a slow browser costs a bounded amount of memory and simply skips values.
    """

    def __init__(self) -> None:
        self._loop: asyncio.AbstractEventLoop | None = None
        self._last: dict[Key, str] = {}
        self._mailboxes: set[Mailbox] = set()

    def attach(self, loop: asyncio.AbstractEventLoop) -> None:
        """The loop in which the mailboxes are read; messages before this are kept as last values."""
        self._loop = loop

    def detach(self) -> None:
        """The loop ends: later messages only change the last values."""
        self._loop = None

    def publish(self, topic: str, map_id: str | None, value: Any) -> None:
        """Tell all browsers; from any thread."""
        text = json.dumps({"topic": topic, "map": map_id, "value": value}, separators=(",", ":"), allow_nan=False)
        if self._loop is None:
            self._keep((topic, map_id), text)
        else:
            self._loop.call_soon_threadsafe(self._deliver, (topic, map_id), text)

    @contextmanager
    def mailbox(self) -> Iterator[Mailbox]:
        """A mailbox with the last value of each key in it, as long as the block runs."""
        box = Mailbox()
        for key, text in self._last.items():
            box.put(key, text)
        self._mailboxes.add(box)
        try:
            yield box
        finally:
            self._mailboxes.discard(box)

    def _deliver(self, key: Key, text: str) -> None:
        self._keep(key, text)
        for box in self._mailboxes:
            box.put(key, text)

    def _keep(self, key: Key, text: str) -> None:
        if key[0] not in _MOMENTS:
            self._last[key] = text
