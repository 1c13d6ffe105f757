"""A node's cloud for ICP, made from its depth image."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.clock import StageClock
from slam.geometry import transform
from slam.params import Params
from slam.registration.cells import normals, sort, thinned
from slam.types import Frame, Images, Node, Scan

#: Side of the cells in which the neighbours of a normal are looked for, when points are not thinned, metres.
_CELL_M = 0.1


def depth_scan(depth_m: NDArray[np.float32], camera: Camera, params: Params) -> Scan:
    """The cloud of a depth image, decimated, thinned, in the base frame.

    Args:
        depth_m: (h, w) metres along the optical axis, 0 where unknown; the size of the colour image or a fraction.
        camera: of the colour image.
        params: the ``Mem/LaserScan`` parameters are read.
    """
    mem = params.Mem
    step = mem.LaserScanDownsampleStepSize
    z = depth_m[::step, ::step]
    v, u = np.nonzero(np.isfinite(z) & (z > 0))
    # Pixel centres are whole numbers, so a coarser pixel's centre lies between those of the finer ones it covers.
    scale = camera.width / depth_m.shape[1]
    pixels = (np.column_stack([u, v]) * step + 0.5) * scale - 0.5
    points = transform(camera.T_base_cam, camera.unproject(pixels, z[v, u]))
    if mem.LaserScanVoxelSize > 0:
        points = thinned(points, mem.LaserScanVoxelSize)
    if mem.LaserScanNormalK == 0:
        return Scan(points.astype(np.float32))
    found = normals(sort(points, normal_cell(mem.LaserScanVoxelSize)), mem.LaserScanNormalK)
    known = np.isfinite(found[:, 0])
    return Scan(points[known].astype(np.float32), found[known].astype(np.float32))


def normal_cell(voxel_size: float) -> float:
    """Side of the cells, metres, in which the neighbours of points that were thinned by cubes are found fast."""
    return 1.5 * voxel_size if voxel_size > 0 else _CELL_M


def equipped(node: Node, frame: Frame, params: Params, clock: StageClock) -> Node:
    """A new node with what registrations need beside its key points.

    That is its cloud where ``Reg/Strategy`` asks for ICP, and its images where ``Vis/CorType`` asks for optical flow.
    """
    stored = None if frame.stored is None else frame.stored.scan
    if params.Reg.Strategy > 0 and stored is not None:
        node = replace(node, scan=stored)
    elif params.Reg.Strategy > 0 and frame.depth_m.size:
        with clock.stage("TimingMem/Scan_filtering/ms"):
            node = replace(node, scan=depth_scan(frame.depth_m, frame.camera, params))
    if params.Vis.CorType == 0 or not frame.image_bgr.size:
        return node
    gray = np.asarray(cv2.cvtColor(frame.image_bgr, cv2.COLOR_BGR2GRAY), np.uint8)
    return replace(node, images=Images(gray, frame.depth_m))
