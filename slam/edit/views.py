"""What a map file holds of nodes, as registrations look at it."""

from __future__ import annotations

from collections import OrderedDict
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.errors import DatabaseError, DecisionError
from slam.features.extract import Extractor
from slam.params import Params
from slam.registration.scan import depth_scan
from slam.registration.view import View
from slam.types import Features, Frame, Images, Scan

#: Views that are kept: whoever works through a map comes back to the same places.
_KEPT = 200


class NodeReader(Protocol):
    """What views ask of a map file."""

    def features(self, node_id: int) -> tuple[Features, NDArray[np.int32]]:
        """Key points of a node, and their words."""
        ...

    def camera(self, node_id: int) -> Camera:
        """The first camera of a node."""
        ...

    def scan(self, node_id: int) -> Scan | None:
        """The stored cloud of a node."""
        ...

    def image_bgr(self, node_id: int) -> NDArray[np.uint8]:
        """The colour image (H, W, 3)."""
        ...

    def depth_m(self, node_id: int) -> NDArray[np.float32]:
        """The depth image (H, W) in metres."""
        ...


class StoredViews:
    """Views of the nodes of a map file: stored key points and cloud, or those made of the stored images."""

    def __init__(self, reader: NodeReader) -> None:
        self._reader = reader
        self._views: OrderedDict[tuple[int, bool], View] = OrderedDict()
        self._params: Params | None = None

    def of(self, node_id: int, params: Params, *, cloud: bool) -> View:
        """A node as a registration sees it, by its first camera; with its cloud where that is asked for.

        Raises:
            DecisionError: the file has no calibration of it, or neither key points nor an image.
        """
        if self._params is None or (self._params.Vis, self._params.Mem) != (params.Vis, params.Mem):
            self._views.clear()
            self._params = params
        key = node_id, cloud
        if key not in self._views:
            self._views[key] = self._read(node_id, params, cloud=cloud)
            if len(self._views) > _KEPT:
                self._views.popitem(last=False)
        self._views.move_to_end(key)
        return self._views[key]

    def _read(self, node_id: int, params: Params, *, cloud: bool) -> View:
        try:
            camera = self._reader.camera(node_id)
        except DatabaseError as error:
            raise DecisionError(f"node {node_id} can't be compared: {error}") from error
        scan = self._scan(node_id, camera, params) if cloud else None
        images = self._images(node_id, camera) if params.Vis.CorType == 1 else None
        return View(self._features(node_id, camera, params), camera, scan, images)

    def _scan(self, node_id: int, camera: Camera, params: Params) -> Scan | None:
        """The stored cloud, or that of the depth image; None without both."""
        scan = self._reader.scan(node_id)
        if scan is not None:
            return scan
        depth = self._depth(node_id, camera)
        return depth_scan(depth, camera, params) if depth is not None and depth.any() else None

    def _features(self, node_id: int, camera: Camera, params: Params) -> Features:
        """The stored key points of the first camera; found anew in the image where none have descriptors."""
        features, _ = self._reader.features(node_id)
        if len(features) and features.descriptors.shape[1]:
            return features.take(features.pixels[:, 0] < camera.width) if camera.width else features
        try:
            image = self._reader.image_bgr(node_id)[:, : camera.width]
        except DatabaseError as error:
            raise DecisionError(f"node {node_id} can't be compared: no key points are stored, and {error}") from error
        depth = self._depth(node_id, camera)
        known = np.zeros(image.shape[:2], np.float32) if depth is None else depth
        return Extractor().extract(Frame(0, 0.0, image, known, camera), params)

    def _images(self, node_id: int, camera: Camera) -> Images | None:
        depth = self._depth(node_id, camera)
        if depth is None:
            return None
        gray = cv2.cvtColor(self._reader.image_bgr(node_id)[:, : camera.width], cv2.COLOR_BGR2GRAY)
        return Images(np.asarray(gray, np.uint8), depth)

    def _depth(self, node_id: int, camera: Camera) -> NDArray[np.float32] | None:
        """Depth of the first camera; None where the file has none of the node."""
        try:
            depth = self._reader.depth_m(node_id)
        except DatabaseError:
            return None
        return depth[:, : _share(depth, camera)]


def _share(depth: NDArray[np.float32], camera: Camera) -> int:
    """Columns of the first camera: images of several have one tile for each, depth may be smaller than colour."""
    return round(float(depth.shape[0]) * camera.width / camera.height) if camera.height else int(depth.shape[1])
