"""One frame in, one update out: the order of the pipeline, and nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from slam.accuracy import frames_ate_m
from slam.clock import StageClock
from slam.database import MapReader, MapWriter, Reduction, WordRows
from slam.errors import ParameterError
from slam.features.dictionary_file import open_dictionary
from slam.geometry import Pose, inverse
from slam.graph.graph import PoseGraph
from slam.loop.closing import Closed, close, limited
from slam.loop.detector import Belief, LoopDetector
from slam.maps.grid_layer import GridLayer
from slam.memory.long_term import DatabaseMemory, RamMemory
from slam.memory.memory import Memory
from slam.memory.past import Past
from slam.memory.rehearsal import Rehearsal, apart, moved, rehearse
from slam.memory.tiers import Tiers, Transfer
from slam.motion import Motion
from slam.node_maker import NodeMaker
from slam.odometry.strategy import make_tracker
from slam.params import Effect, Params, Value, spec
from slam.recorder import Recorder
from slam.registration.refining import Neighbor, refine
from slam.registration.scan import equipped
from slam.statistics import Facts, describe
from slam.tracked import TrackedFrames
from slam.types import WEIGHT_INTERMEDIATE, Frame, Link, LinkType, LocalGrid, Node, Odometry, TrackedFrame, Update


class Slam:
    """An RGB-D graph SLAM engine; synchronous, and repeatable bit for bit for the same frames, parameters and seed.

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
    ) -> None:
        """An engine on an empty map, or on what earlier sessions left.

        Args:
            params: to start with.
            writer: of a map file with this session begun; without one nothing is stored.
            seed: of everything random.
            source: what the frames come from, for the sessions that odometry begins anew.
            past: the earlier sessions of that file; until a loop joins it, the new one is a graph of its own.
        """
        self.params = params
        long_term = RamMemory() if writer is None else DatabaseMemory(MapReader(writer.path))
        self.graph = PoseGraph() if past is None else past.graph
        dictionary = open_dictionary(params, seed=seed, map_path=None if writer is None else writer.path)
        self.memory = Memory(long_term, seed=seed, dictionary=dictionary) if past is None else past.memory
        newest_id, map_id = 0 if past is None else past.last_id, 0 if writer is None else writer.map_id
        self._maker = NodeMaker(self.memory, newest_id, map_id)
        self._odometry = make_tracker(params)
        self._motion = Motion()
        self._tracked = TrackedFrames([] if past is None else past.frames)
        self._tiers = Tiers(self.memory, self.graph)
        self._active = self._tiers.active
        self._loops = LoopDetector()
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

    def process(self, frame: Frame) -> Update:
        """Tracks a frame and, where it is due and somewhere new, makes it a node of the map."""
        odometry = self._odometry.track(frame, self.params)
        self._motion.collect(frame, odometry, self.params)
        if not self._due(frame, odometry):
            if self._is_on_the_way(odometry):
                return self._keep_between(frame, odometry)
            self._hang(frame, odometry)
            return self._between_updates(frame, odometry)
        self._motion.updated(frame)
        return self._update(frame, odometry)

    def set_params(self, changes: Mapping[str, Value]) -> Params:
        """Changes parameters from the next frame on; returns those in force.

        Raises:
            ParameterError: unknown, out of bounds, or not one that can change while mapping.
        """
        params = self.params.changed(changes)
        for name in changes:
            if spec(name).effect is not Effect.LIVE:
                raise ParameterError(f"{name} takes effect with the {spec(name).effect.value}, not while mapping")
        self.params = params
        self._recorder.params_changed(self._maker.newest_id, changes, params)
        return params

    def poses_changed(self) -> None:
        """Somebody moved the graph's poses (a decision): the grid follows, and is stored."""
        self._tiers.restrict()
        self._grid.move(self.graph.poses)
        self._recorder.save_grid()

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

    def _update(self, frame: Frame, odometry: Odometry) -> Update:
        clock = StageClock()
        with clock.stage("Timing/Memory_update/ms"):
            node, words = self._maker.make(frame, odometry, self.params, anew=self._restarted)
            rehearsal = rehearse(node, self.memory, self.params)
            if self._stands(node, rehearsal):
                return self._dismiss(frame, odometry, node, rehearsal)
            if self._maker.is_useless(node, self.params, begins=self._last is None):
                return self._dismiss(frame, odometry, node, None)
            if self.params.Mem.RehearsalWeightIgnoredWhileMoving:
                rehearsal = None
            node = equipped(node, frame, self.params, clock)
            left = self.memory.add(node, self.params)
            neighbor = self._insert(node, clock)
            reductions = self._reduce(left)
            gravity = self._level(node, frame)
            self._last = node
            self._motion.begin()
            self._hang(frame, odometry)
        belief = self._loops.recognize(node, self.memory, self._active.graph, self.params, clock)
        with clock.stage("Timing/Reactivation/ms"):
            retrieved = self._tiers.retrieve(node.id, belief.place, self.params)
        tried = self._loops.candidates(node, belief, self.memory, self._active.graph, self.params, clock)
        with clock.stage("Timing/Map_optimization/ms"):
            if self.params.RGBD.LoopCovLimited and self._motion.surest.any():
                tried = [limited(candidate, self._motion.surest) for candidate in tried]
            closed = close(self._active.graph, tried, self.params)
            self._tiers.follow(node.id, closed)
            if rehearsal is not None:
                self.memory.set_weight(rehearsal.node_id, rehearsal.weight)
            node = replace(node, weight=self._tiers.weigh(node.id, node.weight, closed, self.params))
        with clock.stage("TimingMem/Occupancy_grid/ms"):
            grid = self._grid.add(node.id, frame, self.graph.poses, self.params)
            if closed.optimized:
                self._grid.join(self.graph, closed.links, self.params)
                self._grid.follow(self.graph.poses, self._tiers.moved)
        with clock.stage("Timing/Forgetting/ms"):
            transferred = self._tiers.transfer(belief.place, retrieved, clock.elapsed_ms, self.params)
        facts = Facts(
            node, belief, closed, rehearsal, odometry, retrieved, transferred, self._motion.travelled_m, neighbor
        )
        links = (*neighbor.links, *gravity, *closed.links)
        return self._finish(frame, facts, clock, links, words, grid, reductions)

    def _finish(
        self,
        frame: Frame,
        facts: Facts,
        clock: StageClock,
        links: tuple[Link, ...],
        words: WordRows,
        grid: LocalGrid | None = None,
        reductions: tuple[Reduction, ...] = (),
    ) -> Update:
        """Says what was done, and stores it."""
        update = Update(
            frame_index=frame.index,
            stamp=frame.stamp,
            odometry=facts.odometry,
            T_map_base=self.graph.poses[facts.node.id],
            node=facts.node,
            weight=facts.node.weight,
            posterior=facts.belief.posterior,
            candidates=facts.closed.candidates,
            tiers=self.memory.take_moves(),
            optimized=facts.closed.optimized,
            statistics=describe(facts, self.memory, self._active.graph, self._correction, clock),
            time_ms=clock.elapsed_ms,
        )
        self._recorder.write(frame, update, links, words, grid, reductions, self.params)
        return replace(update, time_ms=clock.elapsed_ms)

    def _is_on_the_way(self, odometry: Odometry) -> bool:
        """Whether a frame between two updates becomes an intermediate node (``Rtabmap/CreateIntermediateNodes``)."""
        wanted = self.params.Rtabmap.CreateIntermediateNodes and self.params.Mem.IncrementalMemory
        if not wanted or self._last is None or odometry.T_odom_base is None or not self._motion.goes_on:
            return False
        return apart(self._last.T_odom_base, odometry.T_odom_base, self.params)

    def _keep_between(self, frame: Frame, odometry: Odometry) -> Update:
        """A pose on the path between two places, with a link to the one before."""
        clock = StageClock()
        with clock.stage("Timing/Memory_update/ms"):
            node = self._maker.make_between(frame, odometry)
            self.memory.add_between(node)
            neighbor = self._insert(node, clock)
            self._active.mark_between(node.id)
            gravity = self._level(node, frame)
            self._last = node
            self._motion.begin()
            self._hang(frame, odometry)
            self._tiers.follow(node.id, Closed())
        facts = Facts(node, Belief(None), Closed(), None, odometry, [], Transfer(), self._motion.travelled_m, neighbor)
        return self._finish(frame, facts, clock, (*neighbor.links, *gravity), WordRows.none())

    def _stands(self, node: Node, rehearsal: Rehearsal | None) -> bool:
        """Whether the robot has not moved since the last place, so that the frame is no new one.

        After an intermediate node it may have come back to that place; then it stands if that looks the same.
        """
        if self._last is None:
            return False
        place = self._last
        if place.weight == WEIGHT_INTERMEDIATE:
            if rehearsal is None:
                return False
            place = self.memory.nodes[rehearsal.node_id]
        return not moved(place, node, self.params)

    def _due(self, frame: Frame, odometry: Odometry) -> bool:
        return self._motion.due(frame, odometry, self.params)

    def _between_updates(self, frame: Frame, odometry: Odometry) -> Update:
        return Update(frame.index, frame.stamp, odometry, self._in_map(odometry))

    @property
    def _correction(self) -> Pose:
        """``T_map_odom`` of the last node of this session, before the first one none."""
        if self._last is None:
            return np.eye(4)
        return np.asarray(self.graph.poses[self._last.id] @ inverse(self._last.T_odom_base))

    def _in_map(self, odometry: Odometry) -> Pose | None:
        return None if odometry.T_odom_base is None else np.asarray(self._correction @ odometry.T_odom_base)

    def _hang(self, frame: Frame, odometry: Odometry) -> None:
        self._tracked.hang(frame, odometry, self._last)

    @property
    def _restarted(self) -> bool:
        """Whether odometry began anew since the last node, so that the next one begins a session."""
        return self._last is not None and self._motion.restarted

    def _dismiss(self, frame: Frame, odometry: Odometry, node: Node, rehearsal: Rehearsal | None) -> Update:
        """A frame of a place that is in the map already: the last node weighs more, this one is not kept.

        With intermediate nodes between both it becomes another of those.
        """
        self.memory.forget_words(node)
        if rehearsal is not None:
            self.memory.set_weight(rehearsal.node_id, rehearsal.weight)
            if self._last is not None and self._last.weight == WEIGHT_INTERMEDIATE:
                return self._keep_between(frame, odometry)
        self._hang(frame, odometry)
        return self._between_updates(frame, odometry)

    def _insert(self, node: Node, clock: StageClock) -> Neighbor:
        """Puts a node into the graph; returns its link to the node before it in the same session."""
        last, started = self._last, self._restarted
        self._active.add_node(node.id, node.map_id, node.T_odom_base, self._correction @ node.T_odom_base)
        self._maker.keep(node)
        if started:
            self._recorder.start_session(self.params)
        if last is None or started:
            self._tiers.labelled.add(node.id)
            return Neighbor()
        link = self._motion.link(last, node)
        if WEIGHT_INTERMEDIATE in (last.weight, node.weight):
            self._active.add_link(link)
            return Neighbor(link)
        with clock.stage("Timing/Neighbor_link_refining/ms"):
            neighbor = refine(link, node, last, self.params)
        if neighbor.refined:
            self._active.place(node.id, neighbor.placed(self.graph.poses[last.id]))
        for kept in neighbor.links:
            self._active.add_link(kept)
        return neighbor

    def _reduce(self, left: list[int]) -> tuple[Reduction, ...]:
        """Nodes that left STM become part of older ones that loops tie them to (``Mem/ReduceGraph``)."""
        if not self.params.Mem.ReduceGraph:
            return ()
        reductions = self._tiers.reduce(left)
        for done in reductions:
            self._tracked.rehang(done.node_id, done.into, done.T_into_node)
            self._grid.leave_out(done.node_id)
        return reductions

    def _level(self, node: Node, frame: Frame) -> tuple[Link, ...]:
        """Tells the graph which way is up at a node, where an accelerometer says so."""
        if frame.T_gravity_base is None:
            return ()
        link = Link(node.id, node.id, LinkType.GRAVITY, frame.T_gravity_base, np.eye(6))
        self._active.add_constraint(link)
        return (link,)
