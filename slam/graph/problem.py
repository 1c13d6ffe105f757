"""What of a graph is optimised: the nodes joined with the root, and the constraints that parameters admit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from slam.errors import OptimizationError
from slam.geometry import Array, Pose, inverse
from slam.graph.graph import PoseGraph, name
from slam.params import Params
from slam.types import UNKNOWN_VARIANCE, Link, LinkType

#: Rotations this near to orthonormal are left alone.
_ROUNDING = 1e-14


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """A least squares problem over poses.

    Attributes:
        root: id that holds the map in its place.
        ids: of all nodes, ascending.
        links: between two nodes, by their ids.
        priors: what is known of poses from outside.
        gravity: which way is up at nodes.
        sightings: links from nodes to landmarks (negative ids).
        poses: id -> (4, 4) ``T_map_base`` to start from, of landmarks too.
        held: ids that stay where they are; with any, nothing else is done to hold the root.
    """

    root: int
    ids: Sequence[int]
    links: Sequence[Link]
    priors: Sequence[Link]
    gravity: Sequence[Link]
    sightings: Sequence[Link]
    poses: Mapping[int, Pose]
    held: Sequence[int] = ()

    @classmethod
    def of(cls, graph: PoseGraph, root: int, params: Params) -> Problem:
        """The problem of the component of ``root``; landmarks start where their first sighting puts them."""
        ids = reachable(graph, root, params)
        links = [graph.links[pair] for pair in sorted(graph.links) if pair[0] in ids]
        own = [graph.constraints[key] for key in sorted(graph.constraints) if key[0] in ids]
        priors, gravity, sightings = (
            [link for link in own if link.type is kind and used]
            for kind, used in (
                (LinkType.POSE_PRIOR, not params.Optimizer.PriorsIgnored),
                (LinkType.GRAVITY, params.Optimizer.GravitySigma > 0 and not params.Reg.Force3DoF),
                (LinkType.LANDMARK, not params.Optimizer.LandmarksIgnored),
            )
        )
        poses = {**graph.poses}
        for link in sightings:
            if link.to_id not in poses and link.T_from_to is not None:
                poses[link.to_id] = graph.poses[link.from_id] @ link.T_from_to
        return cls(
            root=root,
            ids=sorted(ids),
            links=links,
            priors=priors,
            gravity=gravity,
            sightings=sightings,
            poses=poses,
            held=sorted(graph.held & ids),
        )

    @property
    def measurements(self) -> list[Link]:
        """All that says where something is."""
        return [*self.links, *self.priors, *self.gravity, *self.sightings]

    @property
    def landmark_ids(self) -> list[int]:
        """Negative ids of all landmarks, from -1 down."""
        return sorted({link.to_id for link in self.sightings}, reverse=True)

    def oriented(self) -> set[int]:
        """Landmarks whose every sighting tells their orientation too."""
        return {link.to_id for link in self.sightings} - {k.to_id for k in self.sightings if not knows_rotation(k)}


def reachable(graph: PoseGraph, node_id: int, params: Params) -> set[int]:
    """Ids that links, or landmarks seen from both sides, join with a node."""
    found = graph.component(node_id)
    if params.Optimizer.LandmarksIgnored:
        return found
    sightings = [link for (_, _, kind), link in graph.constraints.items() if kind is LinkType.LANDMARK]
    while True:
        seen = {link.to_id for link in sightings if link.from_id in found}
        new = {link.from_id for link in sightings if link.to_id in seen} - found
        if not new:
            return found
        for other in sorted(new):
            found |= graph.component(other)


def choose_root(graph: PoseGraph, params: Params, node_id: int) -> int:
    """The node held fixed among those joined with ``node_id``: the oldest, or with OptimizeFromGraphEnd the newest."""
    component = reachable(graph, node_id, params)
    return max(component) if params.RGBD.OptimizeFromGraphEnd else min(component)


def knows_rotation(link: Link) -> bool:
    """Whether a prior or sighting tells more than a position: RTAB-Map marks those that don't by a variance of 9999."""
    return bool((np.diagonal(link.information)[3:] > 1.0 / UNKNOWN_VARIANCE).all())


def stacked(links: Sequence[Link]) -> tuple[Array, Array]:
    """Transforms (N, 4, 4) from the smaller id, with rotations orthonormal, and symmetric informations (N, 6, 6).

    Raises:
        OptimizationError: a link has numbers that are none (named).
    """
    T = np.array([link.T_from_to for link in links], dtype=np.float64)
    information = np.array([link.information for link in links], dtype=np.float64)
    finite = np.isfinite(T).all(axis=(1, 2)) & np.isfinite(information).all(axis=(1, 2))
    if not finite.all():
        link = links[int(np.argmin(finite))]
        raise OptimizationError(f"link {name(link)}: transform and information must be finite numbers")
    turned = np.array([0 < link.to_id < link.from_id for link in links])
    T[turned] = inverse(T[turned])
    return orthonormal(T), 0.5 * (information + information.transpose(0, 2, 1))


def orthonormal(T: Array) -> Array:
    """Poses (..., 4, 4) with rotations orthonormal to double precision (files store single): one Newton step.

    Rotations that are so already stay to the last bit, so that a map that is optimised twice starts where it ended.
    """
    R = T[..., :3, :3]
    RRt = R @ np.swapaxes(R, -1, -2)
    off = np.abs(RRt - np.eye(3)).max(axis=(-1, -2)) > _ROUNDING
    clean = T.copy()
    clean[..., :3, :3] = np.where(off[..., None, None], 1.5 * R - 0.5 * RRt @ R, R)
    return clean
