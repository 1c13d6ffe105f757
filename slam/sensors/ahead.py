"""Preparing the next frames while the current one is in use."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

T = TypeVar("T")
DEPTH = 2


def ahead(count: int, load: Callable[[int], T]) -> Iterator[T]:
    """``load(0) .. load(count - 1)`` in order, computed up to two ahead by one worker thread.

    An error of ``load(i)`` is raised in place of item i, after all items before it. Worth it where ``load``
    releases the GIL (OpenCV, numba with nogil).
    """
    waiting: deque[Future[T]] = deque()
    worker = ThreadPoolExecutor(max_workers=1, thread_name_prefix="frames")
    try:
        for index in range(count):
            waiting.append(worker.submit(load, index))
            if len(waiting) > DEPTH:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
    finally:
        worker.shutdown(wait=True, cancel_futures=True)
