"""Coloured point clouds: one node's with numpy; the whole map's, and PLY, with open3d (known only to this file)."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.errors import DatabaseError, SourceError
from slam.geometry import Pose

Points = NDArray[np.float32]
Colors = NDArray[np.uint8]

#: Points of several clouds together from which on they are thinned on the way.
_THINNED_AT = 2_000_000


def node_cloud(
    image_bgr: Colors, depth_m: NDArray[np.float32], camera: Camera, step: int = 1, max_depth_m: float = 0.0
) -> tuple[Points, Colors]:
    """Points of one view in its base frame.

    Args:
        image_bgr: (H, W, 3) colour image of the camera.
        depth_m: (h, w) metres along the optical axis, 0 where unknown; the size of the image or a fraction of it.
        camera: the camera of the colour image.
        step: use every n-th depth pixel.
        max_depth_m: leave out what is farther; 0 is no limit.

    Returns:
        (N, 3) points in metres and (N, 3) colours, red first.

    Raises:
        SourceError: colour and depth image don't show the same.
    """
    height, width = depth_m.shape
    scale = image_bgr.shape[1] / width
    if abs(image_bgr.shape[0] - scale * height) >= 1:
        colour = f"{image_bgr.shape[1]}x{image_bgr.shape[0]}"
        raise SourceError(f"depth image of {width}x{height} with a colour image of {colour}: need the same proportions")
    v, u = np.mgrid[0:height:step, 0:width:step].reshape(2, -1)
    z = depth_m[v, u]
    keep = np.isfinite(z) & (z > 0) & (z <= (max_depth_m if max_depth_m > 0 else np.inf))
    v, u, z = v[keep], u[keep], z[keep]
    # Pixel centres are whole numbers, so a coarser pixel's centre lies between those of the finer ones it covers.
    pixels = (np.column_stack([u, v]) + 0.5) * scale - 0.5
    points = camera.unproject(pixels, z) @ camera.T_base_cam[:3, :3].T + camera.T_base_cam[:3, 3]
    nearest = np.rint(pixels).astype(np.int64)
    colors = image_bgr[nearest[:, 1].clip(0, image_bgr.shape[0] - 1), nearest[:, 0].clip(0, image_bgr.shape[1] - 1)]
    return points.astype(np.float32), np.ascontiguousarray(colors[:, ::-1])


def assemble(clouds: Iterable[tuple[Pose, Points, Colors]], voxel_m: float) -> tuple[Points, Colors]:
    """All clouds in the map frame, thinned to the mean point and colour of each voxel.

    Args:
        clouds: ``T_map_base`` (4, 4), points (N, 3) of the base frame, and their colours (N, 3).
        voxel_m: side of a voxel in metres, above 0.

    Returns:
        (M, 3) points of the map frame and (M, 3) colours.
    """
    merged: Any = None
    most = _THINNED_AT
    for T_map_base, points, colors in clouds:
        moved = points @ T_map_base[:3, :3].T + T_map_base[:3, 3]
        cloud = _open3d_cloud(moved, colors).voxel_down_sample(voxel_m)
        merged = cloud if merged is None else merged + cloud
        if len(merged.points) > most:
            # Places that were seen many times must not fill the memory.
            merged = merged.voxel_down_sample(voxel_m)
            most = max(_THINNED_AT, 2 * len(merged.points))
    if merged is None:
        return np.zeros((0, 3), dtype=np.float32), np.zeros((0, 3), dtype=np.uint8)
    merged = merged.voxel_down_sample(voxel_m)
    colors = np.rint(np.asarray(merged.colors) * 255).astype(np.uint8)
    return np.asarray(merged.points).astype(np.float32), colors


def write_ply(path: Path, points: Points, colors: Colors) -> None:
    """Write points (N, 3) with colours (N, 3), red first, as binary PLY.

    Raises:
        DatabaseError: the name doesn't end in .ply, or the file can't be written.
    """
    if path.suffix.lower() != ".ply" or not path.parent.is_dir():
        raise DatabaseError(f"{path}: can't be written; name a .ply file in a folder that exists")
    open3d = _open3d()
    cloud = open3d.t.geometry.PointCloud(open3d.core.Tensor(np.asarray(points, dtype=np.float32)))
    cloud.point.colors = open3d.core.Tensor(np.asarray(colors, dtype=np.uint8))
    part = path.with_name(f".{path.stem}.part.ply")
    try:
        written = open3d.t.io.write_point_cloud(str(part), cloud) and part.replace(path)
    except OSError:
        written = None
    finally:
        part.unlink(missing_ok=True)
    if not written:
        raise DatabaseError(f"{path}: the point cloud can't be written; name a file in a writable folder")


def _open3d_cloud(points: NDArray[np.floating], colors: Colors) -> Any:
    open3d = _open3d()
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(np.asarray(points, dtype=np.float64)))
    cloud.colors = open3d.utility.Vector3dVector(colors / 255.0)
    return cloud


def _open3d() -> Any:
    """The library, loaded at first use: it takes a second, and needs a libusb that bare machines lack."""
    import libusb_package

    ctypes.CDLL(str(libusb_package.get_library_path()), mode=ctypes.RTLD_GLOBAL)
    import open3d

    return open3d
