"""One frame in, one update out: the order of the pipeline, and nothing else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slam.clock import StageClock
from slam.database import Reduction, WordRows
from slam.geometry import Pose, inverse
from slam.loop.closing import Closed, limited
from slam.loop.detector import Belief
from slam.memory.rehearsal import Rehearsal, apart, rehearse, rehearsed, stands_still
from slam.memory.tiers import Transfer
from slam.registration.refining import Neighbor, refine
from slam.registration.scan import equipped
from slam.session import Session
from slam.statistics import Facts, describe
from slam.types import WEIGHT_INTERMEDIATE, Frame, Link, LinkType, LocalGrid, Node, Odometry, Update


class Slam(Session):
    """An RGB-D graph SLAM engine; synchronous, and repeatable bit for bit for the same frames, parameters and seed."""

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

    def _update(self, frame: Frame, odometry: Odometry) -> Update:
        clock = StageClock()
        with clock.stage("Timing/Memory_update/ms"):
            node, words = self._maker.make(frame, odometry, self.params, anew=self._restarted)
            rehearsal = rehearse(node, self.memory, self.params)
            stands = stands_still(self._last, node, rehearsal, self.memory, self.params)
            replaced = 0
            if stands and rehearsal is not None and self.params.Mem.RehearsalIdUpdatedToNewOne:
                replaced = rehearsal.node_id
            elif stands:
                return self._dismiss(frame, odometry, node, rehearsal)
            if self._maker.is_useless(node, self.params, begins=self._last is None):
                return self._dismiss(frame, odometry, node, None)
            if self.params.Mem.RehearsalWeightIgnoredWhileMoving and not stands:
                rehearsal = None
            self._recorder.expect(frame)
            node = equipped(node, frame, self.params, clock)
            left = self.memory.add(node, self.params)
            neighbor = self._insert(node, clock)
            reductions = self._merge(node, left if neighbor.links else [], replaced)
            gravity = self._level(node, frame)
        belief = self._loops.recognize(node, self.memory, self._active.graph, self.params, clock)
        with clock.stage("Timing/Reactivation/ms"):
            retrieved = self._tiers.retrieve(node.id, belief.place, self.params)
        tried = self._loops.candidates(node, belief, self.memory, self._active.graph, self.params, clock)
        with clock.stage("Timing/Map_optimization/ms"):
            if self.params.RGBD.LoopCovLimited and self._motion.surest.any():
                tried = [limited(candidate, self._motion.surest) for candidate in tried]
            closed = self._closer.close(self._active.graph, tried, self.params, self._recorder.approved)
            self._tiers.follow(node.id, closed)
            if self._waits_for_loop(neighbor, closed):
                return self._take_back(frame, odometry, node)
            weight = node.weight if rehearsal is None else rehearsed(rehearsal, self.memory, self.params)
            node = replace(node, weight=self._tiers.weigh(node.id, weight, closed, self.params))
            self._keep(frame, odometry, node)
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
        self._recorder.write(frame, update, links, facts.closed.removed, words, grid, reductions, self.params)
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
            self._keep(frame, odometry, node)
            self._tiers.follow(node.id, Closed())
        facts = Facts(node, Belief(None), Closed(), None, odometry, [], Transfer(), self._motion.travelled_m, neighbor)
        return self._finish(frame, facts, clock, (*neighbor.links, *gravity), WordRows.none())

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
        # Where odometry began anew nothing leads from the last node to the frame.
        self._tracked.hang(frame, odometry, None if self._restarted else self._last)

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

    def _merge(self, node: Node, left: list[int], replaced: int) -> tuple[Reduction, ...]:
        """Nodes that left STM become part of older ones (``Mem/ReduceGraph``), the last one perhaps of the new one."""
        reductions = self._tiers.reduce(left) if self.params.Mem.ReduceGraph else ()
        if replaced:
            reductions += self._tiers.replace(replaced, node.id)
        for done in reductions:
            self._tracked.rehang(done.node_id, done.into, done.T_into_node)
            self._grid.leave_out(done.node_id)
        return reductions

    def _waits_for_loop(self, neighbor: Neighbor, closed: Closed) -> bool:
        """Whether a session may not begin with this node, for no loop joins it with the map that is there."""
        begins = self.params.Rtabmap.StartNewMapOnLoopClosure and neighbor.link is None
        return begins and bool(self.memory.wm) and not closed.links

    def _take_back(self, frame: Frame, odometry: Odometry, node: Node) -> Update:
        self._tiers.take_back(node.id)
        self._hang(frame, odometry)
        return self._between_updates(frame, odometry)

    def _keep(self, frame: Frame, odometry: Odometry, node: Node) -> None:
        """The node stays: what comes goes on from it."""
        if self._restarted:
            self._recorder.start_session(self.params)
        self._maker.keep(node)
        self._last = node
        self._motion.begin()
        self._hang(frame, odometry)

    def _level(self, node: Node, frame: Frame) -> tuple[Link, ...]:
        """Tells the graph what is known of a node alone: which way is up, and what the file that is replayed says."""
        links: list[Link] = []
        if frame.T_gravity_base is not None:
            links.append(Link(node.id, node.id, LinkType.GRAVITY, frame.T_gravity_base, np.eye(6)))
        for link in frame.stored.constraints if frame.stored is not None else ():
            links.append(replace(link, from_id=node.id, to_id=link.to_id if link.to_id < 0 else node.id))
        for link in links:
            self._active.add_constraint(link)
        return tuple(links)
