"""One frame in, one update out: the order of the pipeline, and nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from slam.accuracy import frames_ate_m
from slam.clock import StageClock
from slam.database import MapReader, MapWriter, NodeRecord, WordRows
from slam.errors import OptimizationError, ParameterError
from slam.features.dictionary_file import open_dictionary
from slam.features.words import NodeFeatures
from slam.geometry import Pose, between, inverse
from slam.graph.graph import PoseGraph
from slam.graph.optimizer import optimize
from slam.loop.closing import Closed, close, limited
from slam.loop.detector import Belief, LoopDetector
from slam.loop.likelihood import WordBag
from slam.maps.grid_layer import GridLayer
from slam.memory.active_graph import ActiveGraph
from slam.memory.long_term import DatabaseMemory, RamMemory
from slam.memory.memory import Memory
from slam.memory.past import Past
from slam.memory.places import Places
from slam.memory.rehearsal import Rehearsal, moved, rehearse
from slam.memory.retrieval import choose_retrieval
from slam.memory.signature import too_few_words
from slam.memory.speed import Speed
from slam.memory.transfer import choose_transfer
from slam.odometry.strategy import make_tracker
from slam.params import Effect, Params, Value, spec
from slam.registration.refining import Neighbor, refine
from slam.registration.scan import equipped
from slam.statistics import Facts, describe
from slam.types import UNKNOWN_VARIANCE, Frame, Link, LinkType, LocalGrid, Node, Odometry, TrackedFrame, Update

#: Stamps of a 30 Hz camera jitter by less than this share of the time between two updates.
_JITTER = 0.05
#: Nodes in long-term memory that may follow the others at each update, so that all have after so many of them.
_OFTEN = 50


class Slam:
    """An RGB-D graph SLAM engine; synchronous, and repeatable bit for bit for the same frames, parameters and seed.

    Attributes:
        params: in force now.
        graph: all nodes and links with their optimised poses.
        memory: the tiers.
        frames: every frame so far; each hangs on a node.
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
        self.frames: list[TrackedFrame] = [] if past is None else past.frames
        self._newest_id = 0 if past is None else past.last_id
        self._map_id = 0 if writer is None else writer.map_id
        self._writer = writer
        self._seed, self._source = seed, source
        self._odometry = make_tracker(params)
        self._node_features = NodeFeatures()
        self._loops = LoopDetector()
        self._active = ActiveGraph(self.graph)
        self._active.restrict(self.memory.ltm)
        self._places = Places()
        self._places.put(self.graph.poses, sorted(self.memory.ltm))
        self._moved: set[int] = set()
        self._behind = 0
        self._grid = GridLayer(params, None if past is None else past.reader.local_grid)
        self._unwritten: list[TrackedFrame] = []
        self._weights: dict[int, int] = {}
        self._covariance = np.zeros((6, 6))
        self._last: Node | None = None
        self._last_stamp = -np.inf
        self._last_loop = 0
        self._speed, self._too_fast = Speed(), False
        self._surest = np.zeros(6)
        self._travelled_m = 0.0

    def prepare(self, frame: Frame) -> None:
        """May be called, from one other thread, with a frame that is processed soon: that is then done sooner."""
        self._odometry.prepare(frame, self.params)

    def process(self, frame: Frame) -> Update:
        """Tracks a frame and, where it is due and somewhere new, makes it a node of the map."""
        odometry = self._odometry.track(frame, self.params)
        self._collect(odometry)
        self._too_fast = self._speed.exceeds(frame.stamp, odometry.T_odom_base, self.params)
        if not self._due(frame, odometry):
            self._hang(frame, odometry)
            return self._between_updates(frame, odometry)
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
        if self._writer is not None:
            for name in changes:
                self._writer.parameter_change(self._newest_id, name, params.get(name))
        return params

    def poses_changed(self) -> None:
        """Somebody moved the graph's poses (a decision): the grid follows, and is stored."""
        self._active.restrict(self.memory.ltm)
        self._places.put(self.graph.poses, sorted(self.memory.ltm))
        self._grid.move(self.graph.poses)
        if self._writer is not None:
            self._writer.save_grid(self._grid.occupancy())

    def ate_m(self) -> float | None:
        """Absolute trajectory error of all tracked frames, SE(3)-aligned, metres; None without ground truth."""
        return frames_ate_m(self.frames, self.graph.poses, self.graph.links)

    def close(self) -> None:
        """Ends the session in order: all that is tracked is stored, the file is one plain file again."""
        self._settle()
        if self._writer is None:
            return
        self._writer.add_frames(self._unwritten)
        self._unwritten = []
        self._writer.update_nodes(self._weights)
        self._writer.save_poses(self.graph.poses, None)
        self._writer.save_grid(self._grid.occupancy())
        self._writer.close_session(
            ram_ids=self._wm_ids(), ram_word_ids=self.memory.dictionary.ids(), params=self.params, clean=True
        )
        self._writer.close()

    def abandon(self) -> None:
        """Lets go of a file that can't be written any more; what was stored stays sound."""
        if self._writer is not None:
            self._writer.close()

    def _update(self, frame: Frame, odometry: Odometry) -> Update:
        clock = StageClock()
        self._last_stamp = frame.stamp
        with clock.stage("Timing/Memory_update/ms"):
            node, words = self._make_node(frame, odometry)
            rehearsal = rehearse(node, self.memory, self.params)
            if self._last is not None and not moved(self._last, node, self.params):
                return self._dismiss(frame, odometry, node, rehearsal)
            if self._is_useless(node):
                return self._dismiss(frame, odometry, node, None)
            if self.params.Mem.RehearsalWeightIgnoredWhileMoving:
                rehearsal = None
            if self._writer is not None:
                self._writer.expect_images(frame.image_bgr, frame.depth_m)
            node = equipped(node, frame, self.params, clock)
            neighbor = self._insert(node, clock)
            gravity = self._level(node, frame)
            self._last, self._covariance = node, np.zeros((6, 6))
            self._hang(frame, odometry)
        belief = self._loops.recognize(node, self.memory, self._active.graph, self.params, clock)
        with clock.stage("Timing/Reactivation/ms"):
            retrieved = self._retrieve(node, belief)
        tried = self._loops.candidates(node, belief, self.memory, self._active.graph, self.params, clock)
        with clock.stage("Timing/Map_optimization/ms"):
            if self.params.RGBD.LoopCovLimited and self._surest.any():
                tried = [limited(candidate, self._surest) for candidate in tried]
            closed = close(self._active.graph, tried, self.params)
            self._follow(node, closed)
            node = self._weigh(node, rehearsal, closed)
        with clock.stage("TimingMem/Occupancy_grid/ms"):
            grid = self._grid.add(node.id, frame, self.graph.poses, self.params)
            if closed.optimized:
                self._grid.join(self.graph, closed.links, self.params)
                self._grid.follow(self.graph.poses, sorted(self._moved))
        with clock.stage("Timing/Forgetting/ms"):
            transferred = self._transfer(belief, retrieved, clock.elapsed_ms)
        facts = Facts(node, belief, closed, rehearsal, odometry, retrieved, transferred, self._travelled_m, neighbor)
        update = Update(
            frame_index=frame.index,
            stamp=frame.stamp,
            odometry=odometry,
            T_map_base=self.graph.poses[node.id],
            node=node,
            weight=node.weight,
            posterior=belief.posterior,
            candidates=closed.candidates,
            tiers=self.memory.take_moves(),
            optimized=closed.optimized,
            statistics=describe(facts, self.memory, self._active.graph, self._correction, clock),
            time_ms=clock.elapsed_ms,
        )
        self._write(frame, update, (*neighbor.links, *gravity, *closed.links), words, grid)
        return replace(update, time_ms=clock.elapsed_ms)

    def _due(self, frame: Frame, odometry: Odometry) -> bool:
        """Whether a map update is due for this frame (``Rtabmap/DetectionRate``, by the frames' stamps)."""
        if odometry.T_odom_base is None or self._too_fast:
            return False
        rate = self.params.Rtabmap.DetectionRate
        if rate == 0 or self._restarted():
            return True
        # A camera's clock may be set back; waiting until it has caught up would stop the map.
        return not 0.0 <= frame.stamp - self._last_stamp < (1.0 - _JITTER) / rate

    def _restarted(self) -> bool:
        """Whether odometry began anew since the last node."""
        return bool(self._covariance[0, 0] >= UNKNOWN_VARIANCE)

    def _collect(self, odometry: Odometry) -> None:
        """Keeps the largest covariance since the last node: frames share the local map, so errors don't add up."""
        if odometry.T_odom_base is not None and odometry.covariance[0, 0] > self._covariance[0, 0]:
            self._covariance = odometry.covariance

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
        """Adds a frame to the trajectory, relative to the newest node of its session."""
        newest, T_node_base = self._last, None
        if odometry.T_odom_base is not None and newest is not None:
            T_node_base = between(newest.T_odom_base, odometry.T_odom_base)
        lost = "" if odometry.lost is None else odometry.lost.text
        self._track(frame, odometry, 0 if newest is None else newest.id, T_node_base, lost)

    def _track(
        self,
        frame: Frame,
        odometry: Odometry,
        node_id: int,
        T_node_base: Pose | None,
        lost: str,
        covariance: NDArray[np.float64] | None = None,
    ) -> None:
        tracked = TrackedFrame(
            index=frame.index,
            stamp=frame.stamp,
            node_id=node_id,
            T_node_base=T_node_base,
            T_world_base=frame.T_world_base,
            inliers=odometry.inliers,
            odometry_ms=odometry.time_ms,
            lost=lost,
            covariance=covariance,
        )
        self.frames.append(tracked)
        self._unwritten.append(tracked)

    def _make_node(self, frame: Frame, odometry: Odometry) -> tuple[Node, WordRows]:
        assert odometry.T_odom_base is not None
        features, best = self._node_features.of(frame, odometry.features, self.params)
        word_ids, words = self.memory.quantize(features, self.params, best)
        node = Node(
            id=self._newest_id + 1,
            map_id=self._map_id + int(self._last is not None and self._restarted()),
            weight=0,
            stamp=frame.stamp,
            T_odom_base=odometry.T_odom_base,
            features=features,
            word_ids=word_ids,
            camera=frame.camera,
            T_world_base=frame.T_world_base,
        )
        return node, words

    def _dismiss(self, frame: Frame, odometry: Odometry, node: Node, rehearsal: Rehearsal | None) -> Update:
        """A frame of a place that is in the map already: the last node weighs more, this one is not kept."""
        self.memory.forget_words(node)
        if rehearsal is not None:
            self._set_weight(rehearsal.node_id, rehearsal.weight)
        self._hang(frame, odometry)
        return self._between_updates(frame, odometry)

    def _is_useless(self, node: Node) -> bool:
        """Whether a node has too few words to be kept (``Mem/BadSignaturesIgnored``), or to begin a session with."""
        begins = self._last is None and self.params.Rtabmap.StartNewMapOnGoodSignature
        asked = begins or self.params.Mem.BadSignaturesIgnored
        return asked and too_few_words(WordBag.of(node), self.memory, self.params) is not None

    def _insert(self, node: Node, clock: StageClock) -> Neighbor:
        """Puts a node into graph and STM; returns its link to the node before it in the same session."""
        last, started = self._last, self._restarted() and self._last is not None
        self._active.add_node(node.id, node.map_id, node.T_odom_base, self._correction @ node.T_odom_base)
        self.memory.add(node, self.params)
        self._newest_id, self._map_id = node.id, node.map_id
        if started and self._writer is not None:
            self._writer.start_session(self.params, seed=self._seed, source=self._source)
        if last is None or started:
            return Neighbor()
        T_last_node = between(last.T_odom_base, node.T_odom_base)
        self._travelled_m += float(np.linalg.norm(T_last_node[:3, 3]))
        information = np.asarray(np.linalg.inv(self._covariance), np.float64)
        self._surest = np.maximum(self._surest, np.diagonal(information))
        link = Link(node.id, last.id, LinkType.NEIGHBOR, between(node.T_odom_base, last.T_odom_base), information)
        with clock.stage("Timing/Neighbor_link_refining/ms"):
            neighbor = refine(link, node, last, self.params)
        if neighbor.refined:
            self._active.place(node.id, neighbor.placed(self.graph.poses[last.id]))
        for kept in neighbor.links:
            self._active.add_link(kept)
        return neighbor

    def _level(self, node: Node, frame: Frame) -> tuple[Link, ...]:
        """Tells the graph which way is up at a node, where an accelerometer says so."""
        if frame.T_gravity_base is None:
            return ()
        link = Link(node.id, node.id, LinkType.GRAVITY, frame.T_gravity_base, np.eye(6))
        self._active.add_constraint(link)
        return (link,)

    def _follow(self, node: Node, closed: Closed) -> None:
        """All poses follow the optimised ones: those in RAM at once, those in long-term memory now and then."""
        self._moved.add(node.id)
        self._behind += 1
        if closed.optimized:
            self._active.closed(closed.links)
            self._moved.update(self._active.graph.poses)
        if _OFTEN * self._behind >= len(self.memory.ltm):
            self._behind = 0
            followed = self._active.follow()
            self._places.put(self.graph.poses, (i for i in followed if i in self.memory.ltm))
            self._moved.update(followed)

    def _settle(self) -> None:
        """What was put off to keep updates short is done: the whole graph fits together, and the grid follows it."""
        if not self._active.is_whole:
            self._active.follow()
            with suppress(OptimizationError):
                self.graph.poses = optimize(self.graph, self.params).poses
        self._grid.move(self.graph.poses)

    def _retrieve(self, node: Node, belief: Belief) -> list[int]:
        chosen = choose_retrieval(
            self.memory, self.graph, self._places, node_id=node.id, best_id=belief.place, params=self.params
        )
        retrieved = self.memory.retrieve(chosen, self.params)
        self._places.drop(retrieved)
        self._active.come_back(retrieved)
        self._moved.update(retrieved)
        return retrieved

    def _weigh(self, node: Node, rehearsal: Rehearsal | None, closed: Closed) -> Node:
        """Weights after rehearsal and loop closure: a place seen again hands its weight to its newest node."""
        if rehearsal is not None:
            self._set_weight(rehearsal.node_id, rehearsal.weight)
        weight = node.weight
        for link in closed.links:
            if link.type is LinkType.GLOBAL_CLOSURE:
                self._last_loop = link.to_id
                weight += self.memory.weights[link.to_id]
                self._set_weight(link.to_id, 0)
        self.memory.weights[node.id] = weight
        return replace(node, weight=weight)

    def _set_weight(self, node_id: int, weight: int) -> None:
        self.memory.weights[node_id] = self._weights[node_id] = weight

    def _transfer(self, belief: Belief, retrieved: list[int], elapsed_ms: float) -> list[int]:
        chosen = choose_transfer(
            self.memory,
            self.graph,
            retrieved=retrieved,
            elapsed_ms=elapsed_ms,
            best_id=belief.place,
            last_loop_id=self._last_loop,
            params=self.params,
        )
        self.memory.transfer(chosen)
        self._places.put(self.graph.poses, chosen)
        self._active.leave(chosen)
        return chosen

    def _write(
        self, frame: Frame, update: Update, links: tuple[Link, ...], words: WordRows, grid: LocalGrid | None
    ) -> None:
        """One transaction with the node and all that its update changed."""
        if self._writer is None or update.node is None:
            return
        record = NodeRecord(
            node=update.node,
            update=update,
            image_bgr=frame.image_bgr,
            depth_m=frame.depth_m,
            links=links,
            words=words,
            renamed_words=self.memory.take_renamed(),
            grid=grid,
            statistics=update.statistics,
            wm_ids=self._wm_ids() if self.params.Rtabmap.SaveWMState else None,
            weights={i: w for i, w in self._weights.items() if i != update.node.id},
            frames=tuple(self._unwritten),
            poses={i: self.graph.poses[i] for i in sorted(self._moved)},
            grid_map=self._grid.occupancy_in_turn(),
        )
        self._writer.add_node(record)
        self._unwritten, self._weights, self._moved = [], {}, set()

    def _wm_ids(self) -> tuple[int, ...]:
        return tuple(sorted([*self.memory.stm, *self.memory.wm]))
