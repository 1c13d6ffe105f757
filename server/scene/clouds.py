"""The coloured points that the nodes saw."""

from __future__ import annotations

import logging
from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from server.scene.choice import Choice
from server.scene.cloud_points import CloudPoints, points_of_each
from server.scene.node_points import node_points
from server.scene.placed import PlacedGraph
from slam.database import MapReader
from slam.errors import SlamError
from slam.geometry import Pose, to_quat_xyzw

if TYPE_CHECKING:
    from viser import PointCloudHandle, SceneApi

_LOG = logging.getLogger(__name__)
#: Size of a point, by the distance of its neighbours: surfaces close, edges stay fine.
_POINT_SIZE = 0.9
#: Of each cloud so many points are kept here, to tell what the map looks like as a whole.
_SAMPLE = 60


class CloudLayer:
    """One scene node for each chosen node's points, in that node's frame: after a loop closure only poses are sent."""

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._choice = Choice()
        self._poses: dict[int, Pose] = {}
        self._handles: dict[int, PointCloudHandle] = {}
        self._samples: dict[int, NDArray[np.float32]] = {}
        self._unusable: set[int] = set()
        self._with_images: frozenset[int] = frozenset()
        self._visible = True
        self._shown: Collection[int] | None = None

    def draw(
        self,
        graph: PlacedGraph,
        with_images: Collection[int],
        with_scans: Collection[int] = (),
        *,
        visible: bool,
        shown: Collection[int] | None = None,
    ) -> None:
        """Move what is there to where the nodes are now, and choose which clouds are missing.

        Those of other nodes than ``shown`` (all) are kept, but not to be seen.
        """
        self._visible = visible
        self._shown = shown
        self._with_images = frozenset(with_images)
        self._choice.update(graph, {*with_images, *with_scans})
        self._poses = {node_id: graph.T_map[graph.rows[node_id]] for node_id in self._choice.ids}
        for node_id in self._handles.keys() - set(self._choice.ids):
            self._handles.pop(node_id).remove()
            del self._samples[node_id]
        for node_id, handle in self._handles.items():
            T_map_base = self._poses[node_id]
            handle.wxyz, handle.position = wxyz(T_map_base), T_map_base[:3, 3]
            handle.visible = self._is_visible(node_id)

    @property
    def missing(self) -> list[int]:
        """Chosen nodes whose points were not sent yet, the newest last."""
        return [i for i in self._choice.ids if i not in self._handles and i not in self._unusable]

    def load(self, reader: MapReader, node_ids: Sequence[int]) -> None:
        """Read and send the points of these nodes; those whose images can't be used are left out from now on."""
        most = points_of_each(len(self._choice.ids))
        for node_id in node_ids:
            T_map_base = self._poses[node_id]
            try:
                cloud = node_points(reader, node_id, T_map_base, most, images=node_id in self._with_images)
            except SlamError as error:
                _LOG.info("no cloud: %s", error)
                self._unusable.add(node_id)
                continue
            if len(cloud.points):
                self._send(node_id, cloud, T_map_base)
            else:
                self._unusable.add(node_id)

    def _send(self, node_id: int, cloud: CloudPoints, T_map_base: Pose) -> None:
        self._samples[node_id] = cloud.points[:: max(1, len(cloud.points) // _SAMPLE)]
        self._handles[node_id] = self._scene.add_point_cloud(
            f"/cloud/{node_id}",
            cloud.points,
            cloud.colours,
            point_size=_POINT_SIZE * cloud.spacing,
            point_shape="rounded",
            point_shading="flat",
            wxyz=wxyz(T_map_base),
            position=T_map_base[:3, 3],
            visible=self._is_visible(node_id),
        )

    def _is_visible(self, node_id: int) -> bool:
        return self._visible and (self._shown is None or node_id in self._shown)

    def sample(self) -> NDArray[np.float64]:
        """Some points (N, 3) of all clouds sent so far, in the map frame."""
        placed = [points @ self._poses[i][:3, :3].T + self._poses[i][:3, 3] for i, points in self._samples.items()]
        return np.concatenate([np.zeros((0, 3)), *placed])


def wxyz(T_a_b: Pose) -> NDArray[np.float64]:
    """The rotation of a pose as viser wants it: w x y z."""
    return np.roll(to_quat_xyzw(T_a_b), 1)
