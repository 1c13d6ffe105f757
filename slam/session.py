"""A running session: what it is made of, its parameters and its end."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from slam.accuracy import frames_ate_m
from slam.database import MapReader, MapWriter
from slam.features.dictionary_file import open_dictionary
from slam.graph.graph import PoseGraph
from slam.loop.closing import LoopCloser
from slam.loop.detector import LoopDetector
from slam.maps.grid_layer import GridLayer
from slam.memory.long_term import DatabaseMemory, RamMemory
from slam.memory.memory import Memory
from slam.memory.past import Past
from slam.memory.tiers import Tiers
from slam.motion import Motion
from slam.node_maker import NodeMaker
from slam.odometry.strategy import Tracker, make_tracker
from slam.params import Params, Value, require_live
from slam.recorder import Recorder
from slam.tracked import TrackedFrames
from slam.types import Frame, Node, TrackedFrame


class Session:
    """The parts of an engine; whoever takes it further says what happens with a frame.

    Attributes:
        params: in force now.
        graph: all nodes and links with their optimised poses.
        memory: the tiers.
    """

    def __init__(
        self,
        params: Params,
        writer: MapWriter | None = None,
        *,
        seed: int = 0,
        source: str = "",
        past: Past | None = None,
        tracker: Tracker | None = None,
    ) -> None:
        """An engine on an empty map, or on what earlier sessions left.

        Args:
            params: to start with.
            writer: of a map file with this session begun; without one nothing is stored.
            seed: of everything random.
            source: what the frames come from, for the sessions that odometry begins anew.
            past: the earlier sessions of that file; until a loop joins it, the new one is a graph of its own.
            tracker: gives the frames their odometry; None for the one that the parameters name.
        """
        self.params = params
        long_term = RamMemory() if writer is None else DatabaseMemory(MapReader(writer.path))
        self.graph = PoseGraph() if past is None else past.graph
        dictionary = open_dictionary(params, seed=seed, map_path=None if writer is None else writer.path)
        self.memory = Memory(long_term, seed=seed, dictionary=dictionary) if past is None else past.memory
        newest_id, map_id = 0 if past is None else past.last_id, 0 if writer is None else writer.map_id
        self._maker = NodeMaker(self.memory, newest_id, map_id)
        self._odometry = make_tracker(params) if tracker is None else tracker
        self._motion = Motion()
        self._tracked = TrackedFrames([] if past is None else past.frames)
        self._tiers = Tiers(self.memory, self.graph)
        self._active = self._tiers.active
        self._loops = LoopDetector()
        self._closer = LoopCloser(self._active.try_loops)
        self._grid = GridLayer(params, None if past is None else past.reader.local_grid)
        self._recorder = Recorder(writer, self._tiers, self._tracked, self._grid, seed=seed, source=source)
        self._last: Node | None = None

    @property
    def frames(self) -> list[TrackedFrame]:
        """Every frame so far; each hangs on a node."""
        return self._tracked.frames

    def prepare(self, frame: Frame) -> None:
        """May be called, from one other thread, with a frame that is processed soon: that is then done sooner."""
        self._odometry.prepare(frame, self.params)

    def set_params(self, changes: Mapping[str, Value]) -> Params:
        """Changes parameters from the next frame on; returns those in force.

        Raises:
            ParameterError: unknown, out of bounds, or not one that can change while mapping.
        """
        params = self.params.changed(changes)
        require_live(changes, "while mapping")
        self.params = params
        self._recorder.params_changed(self._maker.newest_id, changes, params)
        return params

    def params_decided(self, params: Params) -> None:
        """A decision changed parameters, which the file knows already: they hold from the next frame on."""
        self.params = params

    def poses_changed(self) -> None:
        """Somebody moved the graph's poses (a decision): the grid follows, and is stored."""
        self._tiers.restrict()
        self._grid.move(self.graph.poses)
        self._recorder.save_grid()

    def keep(self, node_ids: Iterable[int]) -> None:
        """Somebody labelled these nodes: with ``Mem/ReduceGraph`` they never become part of others."""
        self._tiers.labelled.update(node_ids)

    def ate_m(self) -> float | None:
        """Absolute trajectory error of all tracked frames, SE(3)-aligned, metres; None without ground truth."""
        return frames_ate_m(self.frames, self.graph.poses, self.graph.links)

    def close(self) -> None:
        """Ends the session in order: what was put off is done, all is stored, the file is one plain file again."""
        self._tiers.settle(self.params)
        self._grid.move(self.graph.poses)
        self._recorder.close(self.params)

    def abandon(self) -> None:
        """Lets go of a file that can't be written any more; what was stored stays sound."""
        self._recorder.abandon()
