"""What a running session stores in its map file."""

from __future__ import annotations

from collections.abc import Mapping

from slam.database import MapReader, MapWriter, NodeRecord, Reduction, WordRows
from slam.graph.graph import Pair
from slam.maps.grid_layer import GridLayer
from slam.memory.tiers import Tiers
from slam.params import Params, Value
from slam.tracked import TrackedFrames
from slam.types import WEIGHT_INTERMEDIATE, Frame, Link, LocalGrid, Update


class Recorder:
    """Writes nodes with all that their updates changed; without a writer nothing is stored."""

    def __init__(
        self,
        writer: MapWriter | None,
        tiers: Tiers,
        tracked: TrackedFrames,
        grid: GridLayer,
        *,
        seed: int,
        source: str,
    ) -> None:
        self._writer = writer
        self._tiers, self._tracked, self._grid = tiers, tracked, grid
        self._seed, self._source = seed, source

    def start_session(self, params: Params) -> None:
        """Odometry began anew: what follows is a session of its own."""
        if self._writer is not None:
            self._writer.start_session(params, seed=self._seed, source=self._source)

    def params_changed(self, node_id: int, changes: Mapping[str, Value], params: Params) -> None:
        """Somebody changed parameters after this node."""
        if self._writer is not None:
            for name in changes:
                self._writer.parameter_change(node_id, name, params.get(name))

    def expect(self, frame: Frame) -> None:
        """This frame's node is written next: its images are encoded meanwhile."""
        if self._writer is not None and frame.stored is None:
            self._writer.expect_images(frame.image_bgr, frame.depth_m)

    def approved(self) -> set[Pair]:
        """Loops that somebody said are true."""
        journal = [] if self._writer is None else MapReader(self._writer.path).journal()
        return {entry.pair for entry in journal if entry.action == "approve" and entry.undone_by is None}

    def write(
        self,
        frame: Frame,
        update: Update,
        links: tuple[Link, ...],
        removed: tuple[Link, ...],
        words: WordRows,
        grid: LocalGrid | None,
        reductions: tuple[Reduction, ...],
        params: Params,
    ) -> None:
        """One transaction with the update's node and all that changed with it."""
        if self._writer is None or update.node is None:
            return
        memory, node = self._tiers.memory, update.node
        seen = node.weight != WEIGHT_INTERMEDIATE or params.Mem.IntermediateNodeDataKept
        record = NodeRecord(
            node=node,
            update=update,
            image_bgr=frame.image_bgr if seen and frame.image_bgr.size else None,
            depth_m=frame.depth_m if seen and frame.depth_m.size else None,
            stored=frame.stored,
            links=tuple(link for link in links if self._tiers.graph.has(*link.pair)),
            removed_links=tuple((link.from_id, link.to_id) for link in removed),
            reductions=reductions,
            words=words,
            renamed_words=memory.take_renamed(),
            grid=grid,
            statistics=update.statistics,
            wm_ids=memory.in_ram() if params.Rtabmap.SaveWMState else None,
            weights={i: w for i, w in memory.take_weights().items() if i != node.id},
            frames=self._tracked.take_unwritten(),
            poses=self._tiers.take_poses(),
            grid_map=self._grid.occupancy_in_turn(),
        )
        self._writer.add_node(record)

    def save_grid(self) -> None:
        """The floor plan changed without a new node."""
        if self._writer is not None:
            self._writer.save_grid(self._grid.occupancy())

    def close(self, params: Params) -> None:
        """Ends the session in order: all that is tracked is stored, the file is one plain file again."""
        if self._writer is None:
            return
        memory = self._tiers.memory
        self._writer.add_frames(self._tracked.take_unwritten())
        self._writer.update_nodes(memory.take_weights())
        self._writer.save_poses(self._tiers.graph.poses, None)
        self._writer.save_grid(self._grid.occupancy())
        self._writer.close_session(
            ram_ids=memory.in_ram(), ram_word_ids=memory.dictionary.ids(), params=params, clean=True
        )
        self._writer.close()

    def abandon(self) -> None:
        """Lets go of a file that can't be written any more; what was stored stays sound."""
        if self._writer is not None:
            self._writer.close()
