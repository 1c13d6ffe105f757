"""Hypotheses that were never tried are tried now, in the background."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Iterable

import numpy as np

from slam.database import MapReader
from slam.errors import SlamError
from slam.graph.graph import Pair
from slam.loop.foresight import Hypothesis
from slam.params import Params
from slam.types import Candidate, LinkType, Node, Refusal


class LoopTrials:
    """Registers pairs of nodes by what the file holds of them; each once, until the parameters change."""

    def __init__(self, reader: MapReader) -> None:
        self._reader = reader
        self._lock = threading.Lock()
        self._done: dict[Pair, Candidate] = {}
        self._waiting: deque[Hypothesis] = deque()
        self._asked: set[Pair] = set()
        self._params: Params | None = None
        self._worker: threading.Thread | None = None

    def done(self, params: Params) -> dict[Pair, Candidate]:
        """What the images said so far, with these parameters."""
        with self._lock:
            self._use(params)
            return dict(self._done)

    def ask(self, hypotheses: Iterable[Hypothesis], params: Params) -> None:
        """Have these tried."""
        with self._lock:
            self._use(params)
            wanted = [one for one in hypotheses if one.pair not in self._done]
            for one in wanted:
                if one.pair not in self._asked:
                    self._asked.add(one.pair)
                    self._waiting.append(one)
            if self._waiting and self._worker is None:
                self._worker = threading.Thread(target=self._work, name="loop trials", daemon=True)
                self._worker.start()

    def _use(self, params: Params) -> None:
        if self._params is None or (params.Vis, params.Reg, params.Icp, params.RGBD) != (
            self._params.Vis,
            self._params.Reg,
            self._params.Icp,
            self._params.RGBD,
        ):
            self._done.clear()
            self._waiting.clear()
            self._asked.clear()
        self._params = params

    def _work(self) -> None:
        while True:
            with self._lock:
                if not self._waiting or self._params is None:
                    self._worker = None
                    return
                hypothesis, params = self._waiting.popleft(), self._params
            candidate = self._tried(hypothesis, params)
            with self._lock:
                if params is self._params or hypothesis.pair in self._asked:
                    self._done[hypothesis.pair] = candidate

    def _tried(self, hypothesis: Hypothesis, params: Params) -> Candidate:
        # Compiled code: loaded by the first who asks, not by everybody who starts the server.
        from slam.loop.appearance import verify

        kind = LinkType.GLOBAL_CLOSURE
        try:
            new, old = (self._node(i) for i in (hypothesis.node_id, hypothesis.place_id))
            return verify(new, old, kind, hypothesis.value, params)
        except SlamError as error:
            refusal = Refusal("stored features", 0.0, 0.0, str(error))
            return Candidate(
                hypothesis.node_id, hypothesis.place_id, kind, hypothesis.value, -1, -1, None, None, refusal
            )

    def _node(self, node_id: int) -> Node:
        features, word_ids = self._reader.features(node_id)
        scan = self._reader.scan(node_id)
        return Node(node_id, 0, 0, 0.0, np.eye(4), features, word_ids, self._reader.camera(node_id), scan=scan)
