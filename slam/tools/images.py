"""The images of a map as a folder that cameras' tools read, and that can be mapped again."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.database import MapReader
from slam.database.images import encode_color, encode_depth
from slam.errors import DatabaseError
from slam.geometry import to_quat_xyzw
from slam.saving import save
from slam.sensors.calibration import write_calibration
from slam.types import WEIGHT_INVALID

_T = TypeVar("_T", np.uint8, np.float32)
#: 16-bit depth images count millimetres.
_DEPTH_FACTOR = 1000.0
_JPEG = b"\xff\xd8"


def export_images(reader: MapReader, folder: Path) -> int:
    """Write ``rgb/`` and ``depth/`` by stamp, their lists, calibration and ground truth; a folder for each camera.

    Colour of one camera is written as it is stored, tiles of several as PNG; depth becomes PNG of 16 bits in
    millimetres. ``calibration.yaml`` is what ``slamdeck run`` reads; ``camera.yaml`` has the camera as ROS and RTAB-Map
    write it, with its place on the base.

    Returns:
        The number of images written, of all cameras.

    Raises:
        DatabaseError: the folder is not empty or can't be written, the map has no image, or one can't be decoded.
    """
    table, with_image = reader.nodes(), set(reader.nodes_with("image").tolist())
    rows = [r for r in np.flatnonzero(table.weights > WEIGHT_INVALID) if int(table.ids[r]) in with_image]
    cameras = {int(table.ids[r]): reader.cameras(int(table.ids[r])) for r in rows}
    if not cameras:
        raise DatabaseError(f"{reader.path}: no node has an image, there is nothing to export")
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise DatabaseError(f"{folder} is not empty: name a new folder for the images")
    most, count = max(map(len, cameras.values())), 0
    for number in range(most):
        place = folder if most == 1 else folder / f"cam{number}"
        try:
            (place / "rgb").mkdir(parents=True)
            (place / "depth").mkdir()
            mine = [
                (int(table.ids[r]), float(table.stamps[r])) for r in rows if len(cameras[int(table.ids[r])]) > number
            ]
            count += _write_camera(reader, place, number, mine, cameras)
            _write_truth(place, table.stamps[rows], table.T_world[rows], cameras[mine[0][0]][number])
        except OSError as error:
            raise DatabaseError(f"{place} can't be written: {error.strerror}") from error
    return count


def _write_camera(
    reader: MapReader,
    place: Path,
    number: int,
    nodes: Sequence[tuple[int, float]],
    cameras: dict[int, tuple[Camera, ...]],
) -> int:
    lists: dict[str, list[str]] = {"rgb": [], "depth": []}
    for node_id, stamp in nodes:
        several = len(cameras[node_id])
        blob = reader.image(node_id)
        if several > 1:
            blob = encode_color(_tile(reader.image_bgr(node_id), number, several), ".png")
        _add(place, lists["rgb"], "rgb", stamp, blob, ".jpg" if blob.startswith(_JPEG) else ".png")
        if reader.node(node_id).depth_bytes:
            depth = _tile(reader.depth_m(node_id), number, several)
            _add(place, lists["depth"], "depth", stamp, encode_depth(depth, ".png"), ".png")
    for name, lines in lists.items():
        save(place / f"{name}.txt", "\n".join(["# timestamp filename", *lines, ""]))
    camera = cameras[nodes[0][0]][number]
    write_calibration(place, camera, _DEPTH_FACTOR)
    save(place / "camera.yaml", camera_text(camera, f"cam{number}"))
    return len(nodes)


def _add(place: Path, lines: list[str], kind: str, stamp: float, blob: bytes, ending: str) -> None:
    name = f"{kind}/{stamp:.6f}{ending}"
    save(place / name, blob)
    lines.append(f"{stamp:.6f} {name}")


def _tile(image: NDArray[_T], number: int, several: int) -> NDArray[_T]:
    width = image.shape[1] // several
    return np.ascontiguousarray(image[:, number * width : (number + 1) * width])


def _write_truth(place: Path, stamps: NDArray[np.float64], T_world_base: NDArray[np.float64], camera: Camera) -> None:
    known = np.isfinite(T_world_base).all(axis=(1, 2))
    if known.any():
        lines = ["# timestamp tx ty tz qx qy qz qw"]
        for stamp, T in zip(stamps[known], T_world_base[known] @ camera.T_base_cam, strict=True):
            lines.append(f"{stamp:.6f} " + " ".join(f"{v:.9f}" for v in (*T[:3, 3], *to_quat_xyzw(T[:3, :3]))))
        save(place / "groundtruth.txt", "\n".join([*lines, ""]))


def camera_text(camera: Camera, name: str) -> str:
    """A rectified camera as ROS and RTAB-Map write it, with ``local_transform``: the optical frame in the base."""
    T = camera.T_base_cam[:3]
    storage = cv2.FileStorage(".yaml", cv2.FILE_STORAGE_WRITE | cv2.FILE_STORAGE_MEMORY)
    storage.write("camera_name", name)
    storage.write("image_width", camera.width)
    storage.write("image_height", camera.height)
    matrices = {
        "camera_matrix": camera.K,
        "distortion_coefficients": np.zeros((1, 5)),
        "rectification_matrix": np.eye(3),
        "projection_matrix": np.column_stack([camera.K, np.zeros(3)]),
        "local_transform": T,
    }
    for key, matrix in matrices.items():
        storage.startWriteStruct(key, cv2.FILE_NODE_MAP)
        storage.write("rows", matrix.shape[0])
        storage.write("cols", matrix.shape[1])
        storage.startWriteStruct("data", cv2.FILE_NODE_SEQ | cv2.FILE_NODE_FLOW)
        for value in matrix.ravel().tolist():
            storage.write("", float(value))
        storage.endWriteStruct()
        storage.endWriteStruct()
    storage.write("distortion_model", "plumb_bob")
    return str(storage.releaseAndGetString())
