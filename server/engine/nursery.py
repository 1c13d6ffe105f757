"""Where engine processes come from: a process that has loaded the engine already and splits off copies of itself."""

from __future__ import annotations

import multiprocessing
from multiprocessing.context import ForkServerContext, SpawnContext

_KIND = "forkserver"
#: Loading these takes a second, which nobody should wait for at the first decision about a map.
_LOADED = ["server.engine.editor", "slam.graph.optimizer", "slam.maps.local_grid"]


def nursery() -> ForkServerContext | SpawnContext:
    """The multiprocessing context of engines; where the system can't split processes, each one loads anew."""
    if _KIND in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("forkserver")
    return multiprocessing.get_context("spawn")


def warm_up() -> None:
    """Start the process that engines split off from; returns at once, it loads by itself."""
    if _KIND in multiprocessing.get_all_start_methods():
        from multiprocessing import forkserver

        multiprocessing.set_forkserver_preload(_LOADED)
        forkserver.ensure_running()
