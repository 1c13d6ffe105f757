"""Loop closures are kept only when the optimised graph can live with them (``RGBD/OptimizeMaxError``)."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from slam.errors import OptimizationError
from slam.geometry import Array, Pose, flat, inverse
from slam.graph.graph import PoseGraph, all_ascending, name
from slam.graph.optimizer import Optimized, choose_root, optimize
from slam.graph.shift import angles
from slam.params import Params
from slam.types import UNKNOWN_VARIANCE, Link, Refusal

_TEST = "RGBD/OptimizeMaxError"
#: A strained link that grows by less than this factor is no worse than it was.
_NO_WORSE = 1.02
#: An old link that passes the limit by a growth below this share of it was near it before: among hundreds of links one
#: always is, and would keep every loop out. Beyond twice the limit that is no excuse.
_NEAR_ANYHOW, _NO_EXCUSE = 1.0 / 6.0, 2.0


@dataclass(frozen=True, slots=True, eq=False)
class WorstLink:
    """The links that the poses contradict most.

    Attributes:
        linear: largest axis of the translational residual over its sigma.
        linear_m: that residual in metres.
        linear_link: the link it belongs to, None in a graph without links.
        angular: angle of the residual over its sigma.
        angular_rad: that angle in radians.
        angular_link: the link it belongs to.
    """

    linear: float = 0.0
    linear_m: float = 0.0
    linear_link: Link | None = None
    angular: float = 0.0
    angular_rad: float = 0.0
    angular_link: Link | None = None

    @property
    def ratio(self) -> float:
        """The larger of both, in sigmas: what ``RGBD/OptimizeMaxError`` is compared with."""
        return max(self.linear, self.angular)

    @property
    def link(self) -> Link | None:
        """The link of the larger ratio."""
        return self.linear_link if self.linear >= self.angular else self.angular_link

    @property
    def text(self) -> str:
        """One sentence that names the link, its residual and its sigma."""
        if self.link is None:
            return "no link"
        if self.linear >= self.angular:
            how = f"{self.linear_m:.3f} m off, {self.linear:.1f} sigma of {self.linear_m / self.linear:.3f} m (linear)"
            return f"link {name(self.link)} is {how}" if self.linear else "every link agrees"
        sigma = np.degrees(self.angular_rad / self.angular)
        degrees = np.degrees(self.angular_rad)
        return f"link {name(self.link)} is {degrees:.2f} deg off, {self.angular:.1f} sigma of {sigma:.2f} deg (angular)"


@dataclass(frozen=True, slots=True, eq=False)
class Closure:
    """Outcome of trying loop links together.

    Attributes:
        accepted: whether they are in the graph now.
        optimized: the optimisation with them; its poses are the graph's when accepted.
        worst: the links that contradict those poses most.
        refusal: why they were taken back, None when accepted.
        blamed: the link that spoke against them, None when accepted.
    """

    accepted: bool
    optimized: Optimized
    worst: WorstLink
    refusal: Refusal | None = None
    blamed: Link | None = None


def residual_ratios(links: Sequence[Link], poses: Mapping[int, Pose], *, planar: bool = False) -> Array:
    """Residuals (N, 4) of links: linear in sigmas, in metres, angular in sigmas, in radians.

    Of links in the plane (``Reg/Force3DoF``) only x, y and yaw are looked at.
    As in RTAB-Map the linear ratio is the largest axis over the largest sigma of the three; axes of unknown variance
    (9999 and up) are left out when sigma is picked, and a part of which no axis is known isn't judged (ratio 0).
    """
    links = all_ascending(links)
    T_from_to = np.array([link.T_from_to for link in links])
    T_map_from = np.array([poses[link.from_id] for link in links])
    T_map_to = np.array([poses[link.to_id] for link in links])
    T_is = inverse(T_map_from) @ T_map_to
    if planar:
        T_from_to, T_is = flat(T_from_to), flat(T_is)
    metres = np.abs(T_is[:, :3, 3] - T_from_to[:, :3, 3]).max(axis=1)
    radians = angles(inverse(T_from_to) @ T_is)
    known = np.array([np.diagonal(link.information) for link in links])
    known = np.where(known > 1.0 / UNKNOWN_VARIANCE, known, np.inf)
    weight = np.sqrt(np.column_stack([known[:, :3].min(axis=1), known[:, 3:].min(axis=1)]))
    weight[~np.isfinite(weight)] = 0.0
    return np.column_stack([metres * weight[:, 0], metres, radians * weight[:, 1], radians])


def residual_sigmas(links: Sequence[Link], poses: Mapping[int, Pose], *, planar: bool = False) -> Array:
    """Residuals (N,) of links in sigmas, the larger of linear and angular."""
    return residual_ratios(links, poses, planar=planar)[:, [0, 2]].max(axis=1) if links else np.zeros(0)


def max_error(graph: PoseGraph, poses: Mapping[int, Pose]) -> WorstLink:
    """The worst link of a graph at these poses; links to nodes without one of them are left out."""
    links = [graph.links[pair] for pair in sorted(graph.links) if pair[0] in poses and pair[1] in poses]
    return _worst(links, residual_ratios(links, poses)) if links else WorstLink()


def close_loops(graph: PoseGraph, candidates: Sequence[Link], params: Params, *, at_rest: bool = False) -> Closure:
    """Add loop links, optimise, and keep both links and poses only if no link is worse than ``RGBD/OptimizeMaxError``.

    A link that was worse than that before, say because somebody approved it, is held against the candidates only when
    they make it worse still; otherwise one such link would keep all later loops out. When two sessions meet in a
    candidate, the younger one is first moved there as one rigid piece. When the candidates are refused, or an error
    is raised, the graph is as it was.

    Raises:
        OptimizationError: no candidate, a candidate that doesn't fit the graph, or no solution.
    """
    if not candidates:
        raise OptimizationError("no loop link to add: close_loops needs at least one")
    poses, added = graph.poses, list[Link]()
    try:
        graph.poses = dict(poses)
        for link in candidates:
            join(graph, link)
            added.append(link)
        solved = resting(graph, added) if at_rest else graph
        optimized = optimize(solved, params, root=choose_root(graph, params, candidates[0].from_id))
    except OptimizationError:
        _take_back(graph, added, poses)
        raise
    worst, judged = _judge(graph, optimized, poses, candidates, params)
    if judged is not None:
        _take_back(graph, added, poses)
        limit = params.RGBD.OptimizeMaxError
        refusal = Refusal(_TEST, judged.ratio, limit, f"{judged.text}, more than {_TEST} {limit:g} allows")
        return Closure(False, optimized, worst, refusal, judged.link)
    graph.poses = optimized.poses
    return Closure(True, optimized, worst)


def _judge(
    graph: PoseGraph, optimized: Optimized, before: Mapping[int, Pose], new: Sequence[Link], params: Params
) -> tuple[WorstLink, WorstLink | None]:
    """The worst link of all, and of those that count the worst that is worse than allowed."""
    limit, planar, pairs = params.RGBD.OptimizeMaxError, params.Reg.Force3DoF, {link.pair for link in new}
    # What a robust kernel had switched off already says nothing about the new links.
    off = set(optimized.outliers) - pairs
    links = [graph.links[pair] for pair in sorted(graph.links) if pair not in off]
    ratios = residual_ratios(links, optimized.poses, planar=planar)
    worst = _worst(links, ratios)
    if limit <= 0 or worst.ratio <= limit:
        return worst, None
    # A new link was never better; that of an old one counts where it got worse.
    was = residual_sigmas(links, before, planar=planar)
    allowed = np.maximum(_NO_WORSE * was, np.minimum(was + _NEAR_ANYHOW * limit, _NO_EXCUSE * limit))
    allowed[[link.pair in pairs for link in links]] = 0.0
    counts = np.flatnonzero(ratios[:, [0, 2]].max(axis=1) > np.maximum(allowed, limit))
    if not len(counts):
        return worst, None
    return worst, _worst([links[k] for k in counts], ratios[counts])


def _worst(links: Sequence[Link], ratios: Array) -> WorstLink:
    if not links:
        return WorstLink()
    i, k = int(np.argmax(ratios[:, 0])), int(np.argmax(ratios[:, 2]))
    (linear, metres), (angular, radians) = ratios[i, :2], ratios[k, 2:]
    return WorstLink(float(linear), float(metres), links[i], float(angular), float(radians), links[k])


def resting(graph: PoseGraph, new: Collection[Link]) -> PoseGraph:
    """The same graph without any strain but that of its new links: the others say what the poses say."""
    rest, pairs = graph.copy(), {link.pair for link in new}
    for pair, link in graph.links.items():
        if pair not in pairs:
            T = inverse(graph.poses[link.from_id]) @ graph.poses[link.to_id]
            rest.remove_link(pair)
            rest.add_link(replace(link, T_from_to=T))
    return rest


def join(graph: PoseGraph, link: Link) -> None:
    """Add a link; where it joins two components, the younger one's poses move rigidly so that the link is exact.

    Not in a part of a map whose rim is held: what looks like two components is joined beyond it.

    Raises:
        OptimizationError: the link doesn't fit the graph, which is then as it was.
    """
    component = graph.component(link.from_id)
    if link.to_id not in component and link.T_from_to is not None and not graph.held:
        other = graph.component(link.to_id)
        T_map_to = graph.poses[link.from_id] @ link.T_from_to
        if min(other) > min(component):
            moving, T_new_old = other, T_map_to @ inverse(graph.poses[link.to_id])
        else:
            moving, T_new_old = component, graph.poses[link.to_id] @ inverse(T_map_to)
        graph.poses.update({i: np.asarray(T_new_old @ graph.poses[i]) for i in moving})
    graph.add_link(link)


def _take_back(graph: PoseGraph, added: Sequence[Link], poses: dict[int, Pose]) -> None:
    for link in reversed(added):
        graph.remove_link(link.pair)
    graph.poses = poses
