"""What is handed to the writer: one node with all that its update changed, and one decision."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Pose
from slam.types import (
    WEIGHT_INVALID,
    Descriptors,
    Link,
    LocalGrid,
    Node,
    OccupancyGrid,
    Placement,
    Stored,
    TrackedFrame,
    Update,
)


@dataclass(frozen=True, slots=True, eq=False)
class WordRows:
    """Words of the dictionary: ``ids`` (W,) int32, positive; ``descriptors`` (W, B) uint8 or float32."""

    ids: NDArray[np.int32]
    descriptors: Descriptors

    def __len__(self) -> int:
        return len(self.ids)

    @classmethod
    def none(cls) -> WordRows:
        """No words."""
        return cls(np.zeros(0, dtype=np.int32), np.zeros((0, 0), dtype=np.uint8))


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Reduction:
    """A node that became part of another one, and is no node of the map any more.

    Attributes:
        node_id: the node.
        into: the other one.
        T_into_node: (4, 4) where it was seen from there.
        links: those that the other node got for it.
        marked: rehearsal: its links go, a marker says what it was merged into, and its label goes there.
    """

    node_id: int
    into: int
    T_into_node: Pose
    links: tuple[Link, ...]
    marked: bool = False


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class NodeRecord:
    """One node and all that its update changed; written in one transaction.

    Attributes:
        node: the node, with its final weight.
        image_bgr: (H, W, 3) uint8, None when the image is not kept.
        depth_m: (H, W) float32 metres, None when there is no depth.
        links: new links of this and older nodes, each once; stored in both directions.
        removed_links: pairs of ids whose link goes.
        words: new words of the dictionary.
        renamed_words: node id -> old word -> new one, of older nodes whose words became others that look alike.
        grid: local grid of the node.
        statistics: RTAB-Map's names and values.
        wm_ids: ids in short-term and working memory, None when they are not kept.
        weights: changed weights of older nodes.
        update: what the update did: hypotheses, candidates, tiers.
        frames: the frames tracked since the last node.
        poses: the optimised poses T_map_base that changed, by node id.
        reductions: older nodes that became part of others, in this order.
        merged_into: the node that this one was merged into by rehearsal.
        grid_map: the global grid, where it was made anew; None leaves the stored one.
        stored: what the node takes over from the file that is replayed.
    """

    node: Node
    update: Update
    image_bgr: NDArray[np.uint8] | None = None
    depth_m: NDArray[np.float32] | None = None
    links: tuple[Link, ...] = ()
    removed_links: tuple[tuple[int, int], ...] = ()
    words: WordRows = field(default_factory=WordRows.none)
    renamed_words: Mapping[int, Mapping[int, int]] = field(default_factory=dict)
    grid: LocalGrid | None = None
    statistics: Mapping[str, float] = field(default_factory=dict)
    wm_ids: tuple[int, ...] | None = None
    weights: Mapping[int, int] = field(default_factory=dict)
    frames: tuple[TrackedFrame, ...] = ()
    poses: Mapping[int, Pose] = field(default_factory=dict)
    reductions: tuple[Reduction, ...] = ()
    merged_into: int | None = None
    grid_map: OccupancyGrid | None = None
    stored: Stored | None = None


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class NodeChange:
    """What a decision did to a node.

    Attributes:
        node_id: the node.
        map_id: its session.
        weight_before: its weight; -9 where it was no part of the map.
        weight_after: the same afterwards.
        label_before: its label, empty for none.
        label_after: the same afterwards.
        T_odom_base: (4, 4) odometry pose.
        T_map_base: (4, 4) optimised pose that it had in the map.
        constraints: its priors, gravity and sightings of landmarks, which stay in the file.
    """

    node_id: int
    map_id: int
    weight_before: int
    weight_after: int
    label_before: str
    label_after: str
    T_odom_base: Pose
    T_map_base: Pose
    constraints: tuple[Link, ...] = ()

    @property
    def drops(self) -> bool:
        """Whether it takes the node out of the map."""
        return self.weight_before != WEIGHT_INVALID and self.weight_after == WEIGHT_INVALID

    @property
    def restores(self) -> bool:
        """Whether it puts the node back into the map."""
        return self.weight_before == WEIGHT_INVALID and self.weight_after != WEIGHT_INVALID

    def reversed(self) -> NodeChange:
        """What takes it back."""
        return replace(
            self,
            weight_before=self.weight_after,
            weight_after=self.weight_before,
            label_before=self.label_after,
            label_after=self.label_before,
        )


@dataclass(frozen=True, slots=True)
class SettingChange:
    """A parameter that a decision changed, with its text before and after."""

    name: str
    before: str
    after: str

    def reversed(self) -> SettingChange:
        """What takes it back."""
        return SettingChange(self.name, self.after, self.before)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class GridChange:
    """What a decision did to local grids.

    Attributes:
        of: the entry with which those from before are kept; 0 for this one. Undo and redo exchange them.
        nodes: how many nodes it is about.
        made: id -> the grid made anew; empty once it is written, and where kept ones are exchanged.
    """

    of: int = 0
    nodes: int
    made: Mapping[int, LocalGrid] = field(default_factory=dict)

    def kept(self, number: int) -> GridChange:
        """The same, or what takes it back, as the file has it: with entry ``number``, unless with another already."""
        return GridChange(of=self.of or number, nodes=self.nodes)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class JournalEntry:
    """One decision of a person, with the link before and after, so that it can be undone and attributed.

    Attributes:
        id: running number, given by the file; 0 before it is written.
        time: Unix seconds.
        author: who decided.
        action: a verdict about a loop (``approve``, ``reject``, ``add``), an edit of a link (``refine``, ``edit``,
            ``covariance``, ``reset``, ``cut``, ``bridge``) or of a node (``prior``, ``drop``, ``label``), of all poses
            (``optimise``, ``turn``), of local grids (``regrid``), or ``undo`` or ``redo``.
        from_id: node id.
        to_id: node id.
        link_before: the link before the decision, None when there was none.
        link_after: the link after it, None when there is none.
        note: free text.
        undone_by: id of the entry that undid this one, None while it stands; worked out on reading.
        undoes: id of the entry that this one takes back.
        chi2_before: error of the graph before, None when it was not optimised.
        chi2_after: error of the graph after.
        moved: number of poses that moved.
        max_shift_m: the farthest that one moved, metres.
        ate_before: absolute trajectory error before, metres, None without ground truth.
        ate_after: the same after.
        batch: id of the first entry of those that were decided together, None for one alone; given by the file.
        node: what it did to a node, for edits of nodes.
        setting: the parameter that it changed with the map, None for most.
        placement: what it did to all poses with links as they were, None for most.
        grids: what it did to local grids, None for most.
    """

    action: str
    from_id: int
    to_id: int
    id: int = 0
    time: float = 0.0
    author: str = ""
    link_before: Link | None = None
    link_after: Link | None = None
    note: str = ""
    undone_by: int | None = None
    undoes: int | None = None
    chi2_before: float | None = None
    chi2_after: float | None = None
    moved: int = 0
    max_shift_m: float = 0.0
    ate_before: float | None = None
    ate_after: float | None = None
    batch: int | None = None
    node: NodeChange | None = None
    setting: SettingChange | None = None
    placement: Placement | None = None
    grids: GridChange | None = None

    @property
    def pair(self) -> tuple[int, int]:
        """Both ids, smaller first."""
        return min(self.from_id, self.to_id), max(self.from_id, self.to_id)
