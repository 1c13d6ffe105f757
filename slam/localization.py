"""Localisation in a finished map (``Mem/IncrementalMemory`` false): frames are recognised, and not kept."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slam.accuracy import map_error_m
from slam.clock import StageClock
from slam.database import MapWriter, NodeRecord
from slam.geometry import Pose, between
from slam.loop.closing import Closed
from slam.loop.detector import Belief, LoopDetector
from slam.loop.localizer import Localizer
from slam.memory.past import Past
from slam.memory.rehearsal import moved
from slam.params import Params
from slam.registration.refining import Neighbor
from slam.slam import Slam
from slam.statistics import Facts, describe
from slam.types import WEIGHT_INVALID, Candidate, Frame, Link, Node, Odometry, Update


class Localization(Slam):
    """The engine on a map that stays as it is; ``frames`` are those of this session only."""

    def __init__(
        self, params: Params, past: Past, writer: MapWriter | None = None, *, seed: int = 0, source: str = ""
    ) -> None:
        """An engine on the map of earlier sessions; without a writer the file is only read."""
        super().__init__(params, writer, seed=seed, source=source, past=replace(past, frames=[]))
        self._writer = writer
        self._past = past
        self._left = past.reader.memory_ids()
        self._localizer = _at_start(past, params)

    @property
    def localized(self) -> bool:
        """Whether the map has been recognised since odometry last began."""
        return self._localizer.localized

    def close(self) -> None:
        """Ends the session: the path of its frames and the robot's last pose are stored, the map is what it was."""
        if self._writer is None:
            return
        self._writer.add_frames(self._tracked.take_unwritten())
        if self.localized and self._last is not None:
            self._writer.save_last_pose(self._localizer.T_map_odom @ self._last.T_odom_base)
        node_ids, word_ids = self._left
        self._writer.close_session(ram_ids=node_ids.tolist(), ram_word_ids=word_ids.tolist(), params=self.params)
        self._writer.close()

    def ate_m(self) -> float | None:
        """Error of the localised frames in the frame that the map's own nodes and their ground truth define, metres."""
        table = self._past.reader.nodes()
        truth = dict(zip(table.ids.tolist(), table.T_world, strict=True))
        return map_error_m(self.frames, self.graph.poses, truth)

    def _due(self, frame: Frame, odometry: Odometry) -> bool:
        """As in mapping; a robot that does not know where it is looks at every frame."""
        return odometry.T_odom_base is not None and (not self.localized or super()._due(frame, odometry))

    def _update(self, frame: Frame, odometry: Odometry) -> Update:
        clock = StageClock()
        assert odometry.T_odom_base is not None
        began = self._last is None or self._motion.restarted
        if began:
            self._localizer.begin(odometry.T_odom_base)
            # Where it was believed to be says nothing any more: it may have been carried away.
            self._loops = LoopDetector()
        with clock.stage("Timing/Memory_update/ms"):
            node, _ = self._maker.make(frame, odometry, self.params, anew=self._restarted)
            if not began and self.localized and self._last is not None and not moved(self._last, node, self.params):
                return self._dismiss(frame, odometry, node, None)
            motion = None if began or self._last is None else self._motion.link(self._last, node)
            self._active.add_node(node.id, node.map_id, node.T_odom_base, self._localizer.T_map_odom @ node.T_odom_base)
            self.memory.add(node, self.params)
        belief, retrieved, judged = self._look(node, motion, clock)
        with clock.stage("Timing/Forgetting/ms"):
            transferred = self._tiers.transfer(belief.place, retrieved, clock.elapsed_ms, self.params)
        self._last = node
        self._motion.begin()
        self._maker.keep(node)
        self._hang(frame, odometry)
        facts = Facts(
            node,
            belief,
            Closed(tuple(judged)),
            None,
            odometry,
            retrieved,
            transferred,
            self._motion.travelled_m,
            Neighbor(),
        )
        update = Update(
            frame_index=frame.index,
            stamp=frame.stamp,
            odometry=odometry,
            T_map_base=self.graph.poses[node.id],
            covariance=self._localizer.covariance(node.T_odom_base, np.zeros((6, 6))),
            posterior=belief.posterior,
            candidates=tuple(judged),
            statistics=describe(facts, self.memory, self._active.graph, self._localizer.T_map_odom, clock),
        )
        self._let_go(node)
        update = replace(update, tiers=self.memory.take_moves(), time_ms=clock.elapsed_ms)
        if self.params.Mem.LocalizationDataSaved:
            self._store(frame, node, update)
        return update

    def _look(self, node: Node, motion: Link | None, clock: StageClock) -> tuple[Belief, list[int], list[Candidate]]:
        """What is believed of a node's place, what came back from long-term memory, and what the images say of it."""
        home = self._localizer.reference
        known = home if self.localized else 0
        belief = self._loops.recognize(node, self.memory, self._active.graph, self.params, clock, home=known)
        with clock.stage("Timing/Reactivation/ms"):
            retrieved = self._tiers.retrieve(node.id, belief.place, self.params)
        tried = self._loops.candidates(node, belief, self.memory, self._active.graph, self.params, clock, home=home)
        with clock.stage("Timing/Map_optimization/ms"):
            judged = self._localizer.update(node, motion, tried, self.graph.poses, self.params)
        self.graph.poses[node.id] = self._localizer.T_map_odom @ node.T_odom_base
        return belief, retrieved, judged

    def _let_go(self, node: Node) -> None:
        """The map is what it was: the node leaves memory and graph."""
        self.memory.dismiss(node.id)
        self._active.remove_node(node.id)
        self.memory.take_renamed()

    def _store(self, frame: Frame, node: Node, update: Update) -> None:
        """Stores what was seen as a node that is no part of the map (weight -9), with no loops to be decided about."""
        if self._writer is None:
            return
        dropped = replace(node, weight=WEIGHT_INVALID)
        record = NodeRecord(
            node=dropped,
            update=replace(update, node=dropped, weight=WEIGHT_INVALID, candidates=()),
            image_bgr=frame.image_bgr,
            depth_m=frame.depth_m,
            statistics=update.statistics,
            frames=self._tracked.take_unwritten(),
        )
        self._writer.add_node(record)

    def _between_updates(self, frame: Frame, odometry: Odometry) -> Update:
        return replace(super()._between_updates(frame, odometry), covariance=self._uncertainty(odometry))

    def _uncertainty(self, odometry: Odometry) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]] | None:
        if odometry.T_odom_base is None:
            return None
        return self._localizer.covariance(odometry.T_odom_base, self._motion.covariance)

    def _in_map(self, odometry: Odometry) -> Pose | None:
        if odometry.T_odom_base is None:
            return None
        return np.asarray(self._localizer.T_map_odom @ odometry.T_odom_base)

    def _hang(self, frame: Frame, odometry: Odometry) -> None:
        """Adds a frame to the path, relative to the place of the map that was recognised last."""
        T_map_base, place = self._in_map(odometry), self._localizer.reference
        known = self.localized and T_map_base is not None
        self._tracked.add(
            frame,
            odometry,
            node_id=place if known else 0,
            T_node_base=between(self.graph.poses[place], T_map_base) if known and T_map_base is not None else None,
            lost="" if known else "not localised in the map yet",
            covariance=self._uncertainty(odometry),
        )


def _at_start(past: Past, params: Params) -> Localizer:
    """Beside the node nearest to where the robot was last, or at the first node (``RGBD/StartAtOrigin``)."""
    poses = past.graph.poses
    if not poses:
        return Localizer(None, 0)
    if params.RGBD.StartAtOrigin or past.T_map_base is None:
        first = min(poses)
        return Localizer(poses[first], first)
    here = past.T_map_base[:3, 3]
    nearest = min(sorted(poses), key=lambda i: float(np.linalg.norm(poses[i][:3, 3] - here)))
    return Localizer(past.T_map_base, nearest)
