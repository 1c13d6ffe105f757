"""Where the nodes of the files that are replayed have come to."""

from __future__ import annotations

import numpy as np

from slam.geometry import Pose, between, inverse
from slam.tools.replay import OldId
from slam.types import Link


class NewIds:
    """Old node -> the node of the new map that has its place, and where in that node's frame it was."""

    def __init__(self) -> None:
        self._place: dict[OldId, tuple[int, Pose]] = {}
        self._last: tuple[int, Pose] | None = None

    def __len__(self) -> int:
        return len(self._place)

    def became(self, old: OldId, new_id: int, T_odom_base: Pose) -> None:
        """A node was made of it."""
        self._last = new_id, T_odom_base
        self._place[old] = new_id, np.eye(4)

    def joined(self, old: OldId, T_odom_base: Pose) -> None:
        """It had not moved since the last node, which stands for it."""
        if self._last is not None:
            self._place[old] = self._last[0], between(self._last[1], T_odom_base)

    def get(self, file: int, node_id: int) -> int | None:
        """The new node, None where it was lost."""
        place = self._place.get(OldId(file, node_id))
        return None if place is None else place[0]

    def old_ids(self, file: int) -> dict[int, int]:
        """New node -> the node of a file that it was made of, the first where others joined it."""
        found: dict[int, int] = {}
        for old, (new_id, _) in self._place.items():
            if old.file == file:
                found.setdefault(new_id, old.node_id)
        return found

    def carried(self, file: int, link: Link) -> Link | None:
        """A link between two nodes of a file, now between the new ones; None where one is lost or both are one."""
        a, b = (self._place.get(OldId(file, i)) for i in (link.from_id, link.to_id))
        if a is None or b is None or a[0] == b[0] or link.T_from_to is None:
            return None
        return Link(a[0], b[0], link.type, a[1] @ link.T_from_to @ inverse(b[1]), link.information)
