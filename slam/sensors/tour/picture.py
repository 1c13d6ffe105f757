"""What a camera sees of the scene, without noise."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Pose
from slam.sensors.tour.raster import visible
from slam.sensors.tour.scene import Scene
from slam.sensors.tour.shade import shade, smooth_edges


def picture(scene: Scene, camera: Camera, T_cam_world: Pose) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """Colour (H, W, 3), 0 to 255, and exact 1/z (H, W) in 1/m of what a camera sees."""
    R, size = T_cam_world[:3, :3], (camera.height, camera.width)
    origins, rights, downs = scene.origins @ R.T + T_cam_world[:3, 3], scene.rights @ R.T, scene.downs @ R.T
    corners = np.stack([origins, origins + rights, origins + rights + downs, origins + downs], axis=1)
    face, inverse_z = np.empty(size, np.int32), np.empty(size)
    visible(corners, camera.K, face, inverse_z)
    planes = _texture_planes(origins, rights, downs, scene.atlas.levels[:, 0, 1:])
    image = np.empty((*size, 3), np.float32)
    for paint in (shade, smooth_edges):
        paint(face, planes, scene.atlas.texels, scene.atlas.levels, camera.K, image)
    return image, inverse_z


def _texture_planes(
    origins: NDArray[np.float64], rights: NDArray[np.float64], downs: NDArray[np.float64], sizes: NDArray[np.int64]
) -> NDArray[np.float64]:
    """(F, 3, 3) from a ray (x, y, 1) in the camera to homogeneous texture coordinates; the last is 1/z.

    With the plane's normal n and distance d, z = d / (n . ray) and u = (z ray - origin) . right / |right|^2 * width.
    """
    normals = np.cross(rights, downs)
    inverse_z = normals / (normals * origins).sum(1, keepdims=True)
    axes = (edges * (sizes[:, [k]] / (edges**2).sum(1, keepdims=True)) for k, edges in enumerate((rights, downs)))
    rows = [axis - (origins * axis).sum(1, keepdims=True) * inverse_z for axis in axes]
    return np.stack([*rows, inverse_z], axis=1)
