"""What one map file held at one moment, read part by part as it is asked for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from functools import cached_property

import numpy as np

from server.browse.beliefs import BeliefLog
from server.browse.completion import Completion, complete
from server.browse.statistics import StatisticsLog
from server.browse.stored_parameters import as_params, parameter_texts
from server.browse.told import told_by_statistics
from server.browse.truth import Truth
from slam.database import CandidateRow, Fault, Faults, JournalEntry, MapReader, NodeTable
from slam.errors import DatabaseError
from slam.geometry import Pose
from slam.graph.graph import PoseGraph
from slam.graph.optimizer import chi2, choose_root, optimize
from slam.graph.problem import reachable
from slam.graph.suspicion import Suspicion, suspicions
from slam.graph.verify import residual_ratios
from slam.history import History
from slam.loop.aliasing import LookAlike, look_alike
from slam.params import Params
from slam.types import WEIGHT_INVALID, Candidate, Link, Tier

Pair = tuple[int, int]


class Snapshot:
    """The light parts of a map (no images, no key points); each is read once.

    Attributes:
        revision: grows by one with each change of the file that was noticed.
        reader: of the file.
        tiers: id -> tier of every node.
        faults: rows that make no sense, of what was read so far; everything else is there without them.
    """

    def __init__(
        self,
        reader: MapReader,
        revision: int,
        tiers: Mapping[int, Tier],
        faults: Faults | None = None,
        beliefs: BeliefLog | None = None,
        statistics: StatisticsLog | None = None,
    ) -> None:
        self.reader = reader
        self._statistics = statistics or StatisticsLog(reader)
        self._beliefs = beliefs or BeliefLog(reader)
        self.revision = revision
        self.tiers = tiers
        self.faults: Faults = dict(faults or {})

    @cached_property
    def all_nodes(self) -> NodeTable:
        """All nodes of the file, with the merged and dropped ones, which are no part of the map."""
        return self.reader.nodes(self.faults)

    @cached_property
    def nodes(self) -> NodeTable:
        """The nodes of the map, without the merged and dropped ones."""
        table = self.all_nodes
        kept = table.weights > WEIGHT_INVALID
        return NodeTable(
            ids=table.ids[kept],
            map_ids=table.map_ids[kept],
            weights=table.weights[kept],
            stamps=table.stamps[kept],
            T_odom=table.T_odom[kept],
            T_world=table.T_world[kept],
            labels=tuple(label for label, keep in zip(table.labels, kept, strict=True) if keep),
        )

    @cached_property
    def rows(self) -> dict[int, int]:
        """Row of each node id in ``nodes``."""
        return {int(node_id): row for row, node_id in enumerate(self.nodes.ids)}

    @cached_property
    def completion(self) -> Completion:
        """Optimised poses that the file lacks."""
        if all(node_id in self.stored_poses for pair in self.links for node_id in pair):
            return Completion()
        return complete(_Parts(self.nodes, self.all_links, self.stored_poses), self.stored_poses, self.params)

    @cached_property
    def stored_poses(self) -> dict[int, Pose]:
        """Optimised poses T_map_base as they are in the file."""
        try:
            return self.reader.poses()
        except DatabaseError as error:
            self.faults[Fault("Admin", "1", f"optimised poses, which are worked out anew: {error}")] = None
            return {}

    @cached_property
    def poses(self) -> dict[int, Pose]:
        """T_map_base by id, landmarks (negative) too: optimised, or as odometry says of nodes without links."""
        stored = self.stored_poses | self.completion.poses
        table = self.nodes
        for node_id, T_odom_base in zip(table.ids.tolist(), table.T_odom, strict=True):
            if node_id not in stored and np.isfinite(T_odom_base).all():
                stored[node_id] = T_odom_base
        for link in self.constraints:
            # A landmark without a pose of its own is where the first node that saw it has it.
            if link.to_id < 0 and link.to_id not in stored and link.from_id in stored and link.T_from_to is not None:
                stored[link.to_id] = stored[link.from_id] @ link.T_from_to
        return stored

    @cached_property
    def all_links(self) -> list[Link]:
        """All links of the file, each pair once."""
        return self.reader.links(self.faults)

    @cached_property
    def links(self) -> dict[Pair, Link]:
        """Links between two nodes of the map, by both ids, smaller first."""
        rows = self.rows
        return {
            link.pair: link
            for link in self.all_links
            if link.from_id != link.to_id and link.from_id in rows and link.to_id in rows
        }

    @cached_property
    def constraints(self) -> list[Link]:
        """Priors, gravity and sightings of landmarks of the nodes of the map."""
        return [link for link in self.all_links if link.from_id in self.rows and _is_constraint(link)]

    @cached_property
    def residuals(self) -> dict[Pair, float]:
        """Residual in sigmas of every link whose poses are known: what ``RGBD/OptimizeMaxError`` is compared with."""
        poses = self.poses
        judged = [
            link
            for link in self.links.values()
            if link.T_from_to is not None and link.from_id in poses and link.to_id in poses
        ]
        if not judged:
            return {}
        ratios = residual_ratios(judged, poses)
        worst = np.maximum(ratios[:, 0], ratios[:, 2])
        return {link.pair: float(sigma) for link, sigma in zip(judged, worst, strict=True)}

    @cached_property
    def graph(self) -> PoseGraph:
        """All nodes and links with the poses of this map."""
        return PoseGraph.from_reader(_Parts(self.nodes, self.all_links, self.poses))

    @cached_property
    def optimum(self) -> dict[int, Pose]:
        """The poses that the graph comes to with the parameters of the map: those of a file may be elsewhere."""
        graph = self.graph.copy()
        left = set(graph.poses)
        while left:
            root = choose_root(graph, self.params, max(left))
            graph.poses = optimize(graph, self.params, root=root).poses
            left -= reachable(graph, root, self.params)
        return graph.poses

    @cached_property
    def chi2(self) -> float:
        """Sum of squared, whitened residuals of all links."""
        return chi2(list(self.graph.links.values()), self.graph.poses)

    @cached_property
    def suspicions(self) -> dict[Pair, Suspicion]:
        """What speaks against each loop that has a transform, in the graph or only looked at."""
        graph = self.graph
        loops = {pair: link for pair, link in graph.links.items() if link.type.is_loop}
        for pair, row in self.candidates.items():
            link = row.candidate.link
            if link is not None and pair not in graph.links and graph.has(*pair):
                loops[pair] = link
        return suspicions(graph, list(loops.values()), self.params)

    def look_alike(self, pair: Pair) -> LookAlike | None:
        """The place elsewhere that rivals the one which a hypothesis leads to; None for loops of another kind."""
        row = self.candidates.get(pair)
        if row is None or not np.isfinite(row.candidate.posterior):
            return None
        belief = self._beliefs.at(row.update_id)
        return None if belief is None else look_alike(belief, row.candidate.to_id, self.poses)

    @cached_property
    def loop_counts(self) -> Counter[int]:
        """Number of loop links of every node."""
        return Counter(node_id for pair, link in self.links.items() if link.type.is_loop for node_id in pair)

    @cached_property
    def links_at(self) -> dict[int, list[Link]]:
        """All links of each node, with priors: RTAB-Map's table has an index over one of both ids alone."""
        found: dict[int, list[Link]] = {}
        for link in self.all_links:
            for node_id in {link.from_id, link.to_id}:
                found.setdefault(node_id, []).append(link)
        return found

    @cached_property
    def calibrated(self) -> frozenset[int]:
        """Nodes that have a camera."""
        return frozenset(self.reader.nodes_with("calibration").tolist())

    @cached_property
    def pictured(self) -> frozenset[int]:
        """Nodes that have all that a cloud takes: image, depth and camera."""
        images, depths = self.reader.nodes_with("image"), self.reader.nodes_with("depth")
        return frozenset(images.tolist()) & frozenset(depths.tolist()) & self.calibrated

    @cached_property
    def scanned(self) -> frozenset[int]:
        """Nodes that have points of a scanner."""
        return frozenset(self.reader.nodes_with("scan").tolist())

    @cached_property
    def candidates(self) -> dict[Pair, CandidateRow]:
        """The last word about each pair that was looked at as a loop."""
        return {_pair(row.candidate.from_id, row.candidate.to_id): row for row in self.candidate_rows}

    def looked_at(self, pair: Pair) -> Candidate | None:
        """What a loop was judged by: as slamdeck recorded it, or as RTAB-Map's statistics tell."""
        row = self.candidates.get(pair)
        return self._told.get(pair) if row is None else row.candidate

    @cached_property
    def _told(self) -> dict[Pair, Candidate]:
        untold = {pair: link for pair, link in self.links.items() if link.type.is_loop and pair not in self.candidates}
        return told_by_statistics(self._statistics.table(), untold) if untold else {}

    @cached_property
    def candidate_rows(self) -> list[CandidateRow]:
        """All that was ever said of pairs as loops, oldest first."""
        return self.reader.candidates(faults=self.faults)

    @cached_property
    def journal(self) -> list[JournalEntry]:
        """People's decisions, oldest first."""
        return self.reader.journal(self.faults)

    @cached_property
    def history(self) -> History:
        """Which decisions stand."""
        return History(self.journal)

    @cached_property
    def verdicts(self) -> dict[Pair, JournalEntry]:
        """The last verdict about each pair that stands."""
        return self.history.verdicts()

    @cached_property
    def params(self) -> Params:
        """Parameters of the newest session, with the changes made while it ran."""
        return as_params(self.parameter_texts)

    @cached_property
    def parameter_texts(self) -> dict[str, str]:
        """The same as text, names that slamdeck doesn't know included."""
        return parameter_texts(self.reader, self.faults)

    @cached_property
    def truth(self) -> Truth:
        """Where the nodes truly were."""
        return Truth(self.nodes, self.poses, lambda: self.reader.trajectory(self.faults))

    @cached_property
    def ate_m(self) -> float | None:
        """Absolute trajectory error of all tracked frames (nodes, where frames aren't stored); None without truth."""
        return self.truth.ate_at(self.poses, self.links)


def _is_constraint(link: Link) -> bool:
    return link.to_id < 0 or (link.from_id == link.to_id and link.T_from_to is not None)


def _pair(a: int, b: int) -> Pair:
    return min(a, b), max(a, b)


class _Parts:
    """Nodes, links and poses as a graph is made of them: what makes no sense in the file is left out."""

    def __init__(self, nodes: NodeTable, links: list[Link], poses: dict[int, Pose]) -> None:
        self._nodes, self._links, self._poses = nodes, links, poses

    def nodes(self) -> NodeTable:
        return self._nodes

    def links(self) -> list[Link]:
        return self._links

    def poses(self) -> dict[int, Pose]:
        return self._poses
