"""Where the robot is in a map that stays as it is (RTAB-Map's localisation mode)."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from slam.errors import OptimizationError
from slam.geometry import Array, Pose, adjoint, between, inverse
from slam.graph.graph import PoseGraph
from slam.graph.marginal import marginal_covariance
from slam.graph.optimizer import optimize
from slam.graph.verify import residual_ratios
from slam.params import Params
from slam.types import UNKNOWN_VARIANCE, Candidate, Link, LinkType, Node, Refusal

#: Stands for the origin of the map in the graph that is solved; nodes have positive ids.
_ORIGIN = 0


@dataclass(frozen=True, slots=True, eq=False)
class _Step:
    """An odometry pose that is remembered: its motion since the one before, and the places that it recognised."""

    node: Node
    motion: Link | None
    loops: tuple[Link, ...] = ()


class Localizer:
    """Keeps the last odometry poses with what they recognised, and fits them to the poses of the map.

    Attributes:
        localized: whether the map has been recognised since odometry last began.
        reference: the node of the map that the robot is near to, 0 for unknown.
        T_map_odom: takes odometry poses into the map; a guess while not localised.
    """

    def __init__(self, T_map_base: Pose | None, reference: int) -> None:
        """Starts with a guess of the robot's pose beside a node, or without (None, 0)."""
        self.localized = False
        self.reference = reference
        self.T_map_odom: Pose = np.eye(4)
        self._start = T_map_base
        self._steps: deque[_Step] = deque()
        self._covariance = np.eye(6) * UNKNOWN_VARIANCE
        self._T_odom_last: Pose = np.eye(4)

    def begin(self, T_odom_base: Pose) -> None:
        """Odometry began (anew): nothing joins its poses with earlier ones."""
        if self._start is not None:
            self.T_map_odom = self._start @ inverse(T_odom_base)
            self._start = None
        else:
            self.reference = 0
        self.localized = False
        self._steps.clear()

    def covariance(self, T_odom_base: Pose, motion: Array) -> Array:
        """(6, 6) covariance of a frame's pose in the map, in axes of the map; 9999 while not localised.

        ``motion`` is the covariance of odometry since the last update.
        """
        if not self.localized:
            return np.eye(6) * UNKNOWN_VARIANCE
        turn = adjoint(between(T_odom_base, self._T_odom_last))
        R_map_base = np.kron(np.eye(2), (self.T_map_odom @ T_odom_base)[:3, :3])
        return np.asarray(R_map_base @ (turn @ self._covariance @ turn.T + motion) @ R_map_base.T)

    def update(
        self,
        node: Node,
        motion: Link | None,
        candidates: Sequence[Candidate],
        poses: Mapping[int, Pose],
        params: Params,
    ) -> list[Candidate]:
        """Takes in a new odometry pose; returns the candidates with the verdict of the fit.

        Args:
            node: the new one, which is no part of the map.
            motion: its link with the one before, None when odometry began.
            candidates: places that the images were asked about.
            poses: of the map, which are held by ``RGBD/LocalizationPriorError``.
            params: of this update.
        """
        agreed = [c for c in candidates if c.refusal is None]
        refusal = self._fit(_Step(node, motion, tuple(c.link for c in agreed if c.link)), poses, params)
        judged = {id(c): refusal for c in agreed}
        sure = [c for c in agreed if c.type is LinkType.GLOBAL_CLOSURE]
        if refusal is not None and 0 < len(sure) < len(agreed):
            again = self._fit(_Step(node, motion, tuple(c.link for c in sure if c.link)), poses, params)
            judged |= {id(c): again for c in sure}
            refusal = again
        if refusal is not None:
            self._fit(_Step(node, motion), poses, params)
        return [replace(c, refusal=judged[id(c)]) if judged.get(id(c)) is not None else c for c in candidates]

    def _fit(self, step: _Step, poses: Mapping[int, Pose], params: Params) -> Refusal | None:
        """Fits the remembered poses and this one; remembers it when the fit is good."""
        steps = [*self._steps, step][-max(1, params.RGBD.MaxOdomCacheSize) :]
        loops = [loop for one in steps for loop in one.loops]
        if loops:
            refusal = self._solve(steps, loops, poses, params)
            if refusal is not None:
                return refusal
        else:
            # What was recognised is too long ago to be held against odometry: its pose goes on from there.
            self._go_on(step)
        self._steps = deque(steps)
        self._T_odom_last = step.node.T_odom_base
        return None

    def _go_on(self, step: _Step) -> None:
        if step.motion is None or not self.localized:
            return
        turn = adjoint(between(step.node.T_odom_base, self._T_odom_last))
        self._covariance = turn @ self._covariance @ turn.T + np.linalg.inv(step.motion.information)

    def _solve(
        self, steps: Sequence[_Step], loops: Sequence[Link], poses: Mapping[int, Pose], params: Params
    ) -> Refusal | None:
        graph = self._graph(steps, loops, poses, params)
        try:
            graph.poses = optimize(graph, params, root=_ORIGIN).poses
        except OptimizationError as error:
            return Refusal("optimization", float("nan"), float("nan"), str(error))
        judged = [link for pair, link in sorted(graph.links.items()) if pair[0] != _ORIGIN]
        worst = float(residual_ratios(judged, graph.poses)[:, [0, 2]].max())
        limit = params.RGBD.OptimizeMaxError
        if 0 < limit < worst:
            text = f"the last odometry poses are up to {worst:.1f} sigma off, more than RGBD/OptimizeMaxError {limit:g}"
            return Refusal("RGBD/OptimizeMaxError", worst, limit, text)
        newest = steps[-1].node
        self.T_map_odom = graph.poses[newest.id] @ inverse(newest.T_odom_base)
        self._covariance = marginal_covariance(graph, newest.id, root=_ORIGIN)
        self.localized = True
        self.reference = loops[-1].to_id
        return None

    def _graph(
        self, steps: Sequence[_Step], loops: Sequence[Link], poses: Mapping[int, Pose], params: Params
    ) -> PoseGraph:
        """The remembered poses and the places that they recognised, each of those held by a link to the origin."""
        graph, T_map_odom = PoseGraph(), self.T_map_odom
        if not self.localized:
            first = next(step for step in steps if step.loops)
            T_from_to = first.loops[0].T_from_to
            assert T_from_to is not None
            T_map_from = poses[first.loops[0].to_id] @ inverse(T_from_to)
            T_map_odom = np.asarray(T_map_from @ inverse(first.node.T_odom_base))
        graph.add_node(_ORIGIN, 0, np.eye(4), np.eye(4))
        hold = np.eye(6) / params.RGBD.LocalizationPriorError**2
        for place in sorted({loop.to_id for loop in loops}):
            graph.add_node(place, 0, poses[place], poses[place])
            graph.add_link(Link(_ORIGIN, place, LinkType.POSE_PRIOR, poses[place], hold))
        for k, step in enumerate(steps):
            T_odom = step.node.T_odom_base
            graph.add_node(step.node.id, 0, T_odom, np.asarray(T_map_odom @ T_odom))
            if k and step.motion is not None:
                graph.add_link(step.motion)
        for loop in loops:
            graph.add_link(loop)
        return graph
