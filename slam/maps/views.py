"""What each camera of a node saw: one, several in a row of tiles, or stereo pairs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.maps.stereo import stereo_depth


class ViewReader(Protocol):
    """What is asked of a map file."""

    def image_bgr(self, node_id: int) -> NDArray[np.uint8]:
        """Colour image (H, W, 3), one tile for each camera."""
        ...

    def right_bgr(self, node_id: int) -> NDArray[np.uint8]:
        """Right image (H, W, 3) of stereo pairs, likewise."""
        ...

    def depth_m(self, node_id: int) -> NDArray[np.float32]:
        """Depth image (h, w) in metres, likewise."""
        ...

    def cameras(self, node_id: int) -> tuple[Camera, ...]:
        """Its cameras, left to right."""
        ...

    def baselines(self, node_id: int) -> tuple[float, ...]:
        """Baselines of its stereo pairs; none where depth was measured."""
        ...


Pixel = TypeVar("Pixel", bound=np.generic)


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """Colour (H, W, 3) and depth (h, w) in metres of one camera, 0 where unknown."""

    image_bgr: NDArray[np.uint8]
    depth_m: NDArray[np.float32]
    camera: Camera


def node_views(reader: ViewReader, node_id: int) -> tuple[View, ...]:
    """The views of a node, in the order of its cameras; depth of stereo pairs is worked out from their images.

    Raises:
        DatabaseError: the node lacks an image, or a blob is damaged.
        SourceError: the images of a stereo pair don't fit each other.
    """
    cameras, baselines = reader.cameras(node_id), reader.baselines(node_id)
    images = _tiles(reader.image_bgr(node_id), len(cameras))
    if not baselines:
        depths = _tiles(reader.depth_m(node_id), len(cameras))
        return tuple(View(*view) for view in zip(images, depths, cameras, strict=True))
    rights = _tiles(reader.right_bgr(node_id), len(cameras))
    return tuple(
        View(left, stereo_depth(left, right, camera.fx * left.shape[1] / camera.width, baseline), camera)
        for left, right, camera, baseline in zip(images, rights, cameras, baselines, strict=True)
    )


def node_depths(reader: ViewReader, node_id: int) -> tuple[tuple[NDArray[np.float32], Camera], ...]:
    """Depth (h, w) in metres of each camera of a node, without the colour where depth was measured; raises likewise."""
    if reader.baselines(node_id):
        return tuple((view.depth_m, view.camera) for view in node_views(reader, node_id))
    cameras = reader.cameras(node_id)
    return tuple(zip(_tiles(reader.depth_m(node_id), len(cameras)), cameras, strict=True))


def disparity_px(view: View, baseline: float) -> NDArray[np.float32]:
    """Disparity (h, w) of a stereo pair in pixels of its depth image, 0 where unknown; the baseline in metres."""
    known = view.depth_m > 0
    focal_px = view.camera.fx * view.depth_m.shape[1] / view.camera.width
    return np.where(known, np.float32(focal_px * baseline) / np.where(known, view.depth_m, 1.0), 0.0).astype(np.float32)


def _tiles(image: NDArray[Pixel], count: int) -> list[NDArray[Pixel]]:
    """Parts (H, W / count, ...) of an image, left to right."""
    width = image.shape[1] // count
    return [np.ascontiguousarray(image[:, at * width : (at + 1) * width]) for at in range(count)]
