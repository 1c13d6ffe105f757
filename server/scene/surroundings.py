"""What is around the path, from a few depth images: enough to choose the first view and the height of the floor."""

from __future__ import annotations

import numpy as np

from server.browse.snapshot import Snapshot
from server.scene.model import Array, SceneModel
from slam.database import MapReader
from slam.errors import SlamError
from slam.maps.point_cloud import node_cloud

_LOOKS = 10
_PIXEL_STEP = 16
_FAR_METRES = 4.5


def surroundings(reader: MapReader, snapshot: Snapshot, model: SceneModel) -> Array:
    """Points (N, 3) of the map frame, seen from some nodes spread over it; none where the file has no depth."""
    usable = [i for i in model.ids.tolist() if i in snapshot.calibrated]
    chosen = [usable[k] for k in np.unique(np.linspace(0, len(usable) - 1, _LOOKS).astype(int))] if usable else []
    found = [np.zeros((0, 3))]
    for node_id in chosen:
        try:
            image, depth, camera = reader.image_bgr(node_id), reader.depth_m(node_id), reader.camera(node_id)
            points, _ = node_cloud(image, depth, camera, _PIXEL_STEP, _FAR_METRES)
        except SlamError:
            # Not every node of every file has image and depth; the others say enough.
            continue
        T_map_base = model.T_map_base[model.rows[node_id]]
        found.append(points @ T_map_base[:3, :3].T + T_map_base[:3, 3])
    return np.concatenate(found)
