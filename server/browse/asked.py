"""Who waits for an answer about a map."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

#: A request that takes longer is work of its own, beside which everything else goes on.
_LONGEST_S = 2.0


class Asked:
    """Requests that are being answered: work that nobody waits for lets them pass.

    All threads share one interpreter, so that whatever else is worked out makes answers late.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._since: dict[object, float] = {}

    @contextmanager
    def one(self) -> Iterator[None]:
        """A request, as long as the block lasts."""
        request = object()
        self._since[request] = self._clock()
        try:
            yield
        finally:
            del self._since[request]

    @property
    def is_urgent(self) -> bool:
        """Whether somebody waits, and not for something that takes long."""
        begun = self._clock() - _LONGEST_S
        return any(since > begun for since in self._since.copy().values())
