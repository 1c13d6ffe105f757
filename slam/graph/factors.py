"""The factors that GTSAM is given for a problem, and the values it starts from."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import gtsam
import numpy as np

from slam.errors import OptimizationError
from slam.geometry import Array, Pose
from slam.graph.gauge import gauge
from slam.graph.graph import name
from slam.graph.information import clamped
from slam.graph.kernels import Kernel
from slam.graph.problem import Problem, knows_rotation, orthonormal, stacked
from slam.graph.spaces import Space
from slam.types import Link, LinkType

#: Links whose factors are kept: making one costs as much as a solver iteration on it.
_KEPT = 1 << 15
#: A landmark nearer than this has no direction.
_NEAREST_M = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Factors:
    """Factors of a problem.

    Attributes:
        keys: what each factor was made of: a link, or a tuple for the root; the same object, the same factor.
        factors: GTSAM's, in the order of ``keys``.
        loops: rows of the factors that a robust kernel may take the weight from.
        clamped: number of links whose information had eigenvalues out of bounds.
    """

    keys: Sequence[object]
    factors: Sequence[gtsam.NoiseModelFactor]
    loops: Sequence[int]
    clamped: int

    def graph(self) -> gtsam.NonlinearFactorGraph:
        """All factors as GTSAM's solvers want them."""
        graph = gtsam.NonlinearFactorGraph()
        for factor in self.factors:
            graph.add(factor)
        return graph


@dataclass(frozen=True, slots=True)
class Style:
    """What, beside a link, decides its factor.

    Attributes:
        space: three dimensions, or the plane.
        kernel: of loop links.
        same_variance: whether all links get identity information.
        gravity_sigma: radians.
    """

    space: Space
    kernel: Kernel
    same_variance: bool = False
    gravity_sigma: float = 1.0


class Workshop:
    """Makes factors, and keeps those of links for the next optimisation."""

    def __init__(self) -> None:
        self._kept: dict[tuple[Style, Link], tuple[gtsam.NoiseModelFactor, bool]] = {}

    def factors(self, problem: Problem, style: Style) -> Factors:
        """All factors of a problem; raises OptimizationError for a link with numbers that are none."""
        links = problem.measurements
        made = self._links(links, problem, style)
        anchors = [_anchor(problem, node_id, style.space) for node_id in problem.held or [problem.root]]
        return Factors(
            keys=[*links, *(key for key, _ in anchors)],
            factors=[*(factor for factor, _ in made), *(factor for _, factor in anchors)],
            loops=[row for row, link in enumerate(links) if link.type.is_loop],
            clamped=sum(was_clamped for _, was_clamped in made),
        )

    def _links(
        self, links: Sequence[Link], problem: Problem, style: Style
    ) -> list[tuple[gtsam.NoiseModelFactor, bool]]:
        found = [self._kept.get((style, link)) for link in links]
        missing = [link for link, known in zip(links, found, strict=True) if known is None]
        if not missing:
            return [known for known in found if known is not None]
        if len(self._kept) + len(missing) > _KEPT:
            self._kept.clear()
        new = iter(list(_made(missing, problem.oriented(), style)))
        made = [next(new) if known is None else known for known in found]
        # What a sighting becomes depends on the landmark's other sightings.
        self._kept.update(((style, k), f) for k, f in zip(links, made, strict=True) if k.to_id > 0)
        return made


def _anchor(problem: Problem, node_id: int, space: Space) -> tuple[object, gtsam.NoiseModelFactor]:
    """What holds a node in its place, with its key."""
    T_map_node = orthonormal(problem.poses[node_id])
    information = gauge(problem, T_map_node)[np.ix_(space.axes, space.axes)]
    factor = space.prior(node_id, T_map_node, gtsam.noiseModel.Gaussian.Information(information))
    return ("held", node_id, T_map_node.tobytes(), information.tobytes()), factor


def _made(links: Sequence[Link], oriented: set[int], style: Style) -> Iterator[tuple[gtsam.NoiseModelFactor, bool]]:
    T, information = stacked(links)
    if style.same_variance:
        information = np.broadcast_to(np.eye(6), information.shape)
    space = style.space
    T = space.flat(T)
    whole, wild = clamped(information[:, space.axes[:, None], space.axes])
    for link, T_from_to, full, matrix, was_clamped in zip(links, T, information, whole, wild, strict=True):
        yield _factor(link, T_from_to, full, matrix, oriented, style), bool(was_clamped)


def _factor(
    link: Link, T: Pose, information: Array, matrix: Array, oriented: set[int], style: Style
) -> gtsam.NoiseModelFactor:
    """One factor: ``information`` (6, 6) as the link has it, ``matrix`` (k, k) that of the space's own axes."""
    space = style.space
    if link.type is LinkType.GRAVITY:
        level = gtsam.noiseModel.Isotropic.Sigma(2, style.gravity_sigma)
        return gtsam.AttitudeFactorPose3(
            link.from_id, gtsam.Unit3(np.array([0.0, 0.0, 1.0])), level, gtsam.Unit3(T[2, :3])
        )
    if link.type in (LinkType.LANDMARK, LinkType.POSE_PRIOR):
        return _single(link, T, information, matrix, oriented, space)
    noise = gtsam.noiseModel.Gaussian.Information(matrix)
    return space.between(*link.pair, T, style.kernel.wrap(noise) if link.type.is_loop else noise)


def _single(
    link: Link, T: Pose, information: Array, matrix: Array, oriented: set[int], space: Space
) -> gtsam.NoiseModelFactor:
    """A prior or a sighting, of the whole pose or of the position alone."""
    whole = gtsam.noiseModel.Gaussian.Information(matrix)
    position = clamped(information[None, space.linear[:, None], space.linear])[0][0]
    if link.type is LinkType.POSE_PRIOR:
        if knows_rotation(link):
            return space.prior(link.from_id, T, whole)
        return space.position(link.from_id, T, gtsam.noiseModel.Gaussian.Information(position))
    if link.to_id in oriented:
        return space.between(link.from_id, landmark_key(link.to_id), T, whole)
    if np.linalg.norm(T[space.linear, 3]) < _NEAREST_M:
        raise OptimizationError(f"link {name(link)}: a landmark where the node is has no direction")
    return space.sighting(link.from_id, landmark_key(link.to_id), T[:3, 3], position)


def landmark_key(landmark_id: int) -> int:
    """GTSAM's key of a landmark (negative id), behind those of all nodes."""
    return int(gtsam.symbol("l", -landmark_id))
