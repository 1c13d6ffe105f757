"""Small map files of every schema since 0.6, with known content, made by plain SQLite as RTAB-Map's history has it.

Three nodes in a row, with the links in both directions and a loop from 3 to 1; image, depth, calibration, scan and
what else the version has. Blobs are packed here by hand, so that a slip of the codecs does not go round in a circle.
"""

from __future__ import annotations

import sqlite3
import struct
import zlib
from contextlib import closing
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.camera import T_BASE_OPTICAL

Version = tuple[int, int, int]
Columns = dict[str, Any]

IMAGE = np.random.default_rng(1).integers(0, 255, (48, 64, 3)).astype(np.uint8)
DEPTH_MM = np.arange(48 * 64, dtype=np.uint16).reshape(48, 64)
SCAN = np.random.default_rng(2).normal(size=(10, 2)).astype(np.float32)
LOCAL = T_BASE_OPTICAL[:3].copy()
LOCAL[:, 3] = 0.25, 0.0, 0.5
T_BASE_SCAN = np.eye(4)[:3].copy()
T_BASE_SCAN[:, 3] = 0.0, 0.0, 0.125
FX, FY, CX, CY = 52.5, 52.25, 31.5, 23.5
BASELINE = 0.125
USER_DATA = b"kitchen"
ROTATION, TRANSLATION = 0.01, 0.04
STATISTICS = "Loop/Id/:1;Timing/Total/ms:12.5"
PARAMETERS = "Kp/WordsPerImage:400;Rtabmap/LoopThr:0.15"
GPS = (1500.5, -71.25, 45.5, 120.0, 2.5, 90.0)
SENSORS = ((2.0, 21.5, 1501.0), (1.0, -60.0, 1502.0))
CELLS = np.array([[[0.5, 0.25, 0.125], [1.0, 0.5, 0.25]]], np.float32)
CLOUD = np.random.default_rng(3).normal(size=(1, 20, 3)).astype(np.float32)


def z(matrix: NDArray[np.generic], kind: int) -> bytes:
    """A compressed matrix of OpenCV's type ``kind``."""
    return zlib.compress(matrix.tobytes()) + struct.pack("<3i", *matrix.shape[:2], kind)


def pose(node_id: int) -> NDArray[np.float32]:
    """Where node ``node_id`` is: the rows (3, 4), half a metre along x from one to the next."""
    rows = np.eye(4, dtype=np.float32)[:3]
    rows[0, 3] = 0.5 * (node_id - 1)
    return rows


def png(image: NDArray[Any]) -> bytes:
    """The image as a PNG."""
    return bytes(cv2.imencode(".png", image)[1])


def write_old(path: Path, version: Version, *, calibration: bytes | None = None, depth: bytes | None = None) -> Path:
    """A file of this version; ``calibration`` and ``depth`` in place of the usual ones."""
    tables = _tables(version, calibration or calibration_of(version), depth or png(DEPTH_MM))
    with closing(sqlite3.connect(path)) as connection:
        for name, rows in tables.items():
            connection.execute(f"CREATE TABLE {name} ({', '.join(rows[0])})")
            marks = ", ".join("?" * len(rows[0]))
            connection.executemany(f"INSERT INTO {name} VALUES ({marks})", [tuple(row.values()) for row in rows])
        connection.commit()
    return path


def calibration_of(version: Version, *, cameras: int = 1, stereo: bool = False) -> bytes:
    """The blob of 0.10.0 and later."""
    if version >= (0, 18, 0):
        numbers = [FX, 0, CX, 0, FY, CY, 0, 0, 1]
        record = struct.pack("<11i9d12f", *version, 0, 64 // cameras, 48, 9, 0, 0, 0, 12, *numbers, *LOCAL.ravel())
        return record * cameras
    numbers = [FX, FY, CX, CY]
    if stereo:
        numbers.append(BASELINE)
    if version >= (0, 11, 2):
        numbers += [64 // cameras, 48]
    return np.array([*numbers, *LOCAL.ravel()] * cameras, "<f4").tobytes()


def _tables(version: Version, calibration: bytes, depth: bytes) -> dict[str, list[Columns]]:
    tables = {
        "Node": [_node(i, version) for i in (1, 2, 3)],
        "Link": [_link(a, b, kind, version) for a, b, kind in _LINKS],
        "Word": [{"id": i, "descriptor_size": 32, "descriptor": bytes([i] * 32), "time_enter": _TIME} for i in (1, 2)],
        _features(version): [_feature(1, 1, version), _feature(1, 2, version), _feature(2, 1, version)],
        "Admin": [_admin(version)],
        "Info" if version >= (0, 11, 11) else "Statistics": [_info(version)],
    }
    if version >= (0, 11, 11):
        tables["Statistics"] = [_statistics(version)]
    if version >= (0, 10, 0):
        tables["Data"] = [_data(i, version, calibration, depth) for i in (1, 2)]
    else:
        tables |= _images(version, depth)
    if version >= (0, 20, 0):
        data = z(np.arange(4, dtype=np.float32)[None], 5)
        tables["GlobalDescriptor"] = [{"node_id": 1, "type": 1, "info": None, "data": data}]
    return tables


_TIME = "2015-01-01 00:00:00"
_LINKS = ((2, 1, 0), (1, 2, 0), (3, 2, 0), (2, 3, 0), (3, 1, 1), (1, 3, 1))


def _features(version: Version) -> str:
    return "Feature" if version >= (0, 13, 0) else "Map_Node_Word"


def _node(node_id: int, version: Version) -> Columns:
    row: Columns = {"id": node_id, "map_id": 0, "weight": 0 if node_id < 3 else 2}
    if version >= (0, 8, 5):
        row |= {"stamp": 100.0 + node_id, "label": "start" if node_id == 1 else None}
    row["pose"] = pose(node_id).tobytes()
    if version >= (0, 11, 1):
        row["ground_truth_pose"] = bytes(48)
    if version >= (0, 13, 0):
        row["velocity"] = struct.pack("<6f", 1, 2, 3, 4, 5, 6)
    if version >= (0, 14, 0):
        row["gps"] = struct.pack("<6d", *GPS) if node_id == 1 else None
    if version >= (0, 18, 0):
        row["env_sensors"] = b"".join(struct.pack("<3d", *s) for s in SENSORS) if node_id == 1 else None
    if (0, 8, 8) <= version < (0, 10, 1):
        row["user_data"] = USER_DATA if node_id == 1 else None
    return row | {"time_enter": _TIME}


def _link(from_id: int, to_id: int, kind: int, version: Version) -> Columns:
    transform = np.eye(4, dtype=np.float32)[:3]
    transform[0, 3] = 0.5 * (to_id - from_id)
    row: Columns = {"from_id": from_id, "to_id": to_id, "type": kind}
    if version >= (0, 13, 0):
        row["information_matrix"] = np.diag([1 / TRANSLATION] * 3 + [1 / ROTATION] * 3).tobytes()
    elif version >= (0, 8, 4):
        row |= {"rot_variance": ROTATION, "trans_variance": TRANSLATION}
    elif version >= (0, 7, 4):
        row["variance"] = ROTATION
    row["transform"] = transform.tobytes()
    return row | ({"user_data": None} if version >= (0, 10, 10) else {})


def _feature(node_id: int, word_id: int, version: Version) -> Columns:
    row: Columns = {"node_id": node_id, "word_id": word_id, "pos_x": 1.5, "pos_y": 2.5, "size": 7}
    row |= {"dir": 45.0, "response": 0.5}
    if version >= (0, 12, 0):
        row["octave"] = 1
    row |= {"depth_x": 1.0, "depth_y": 2.0, "depth_z": 3.0}
    return row | ({"descriptor_size": 32, "descriptor": bytes([word_id] * 32)} if version >= (0, 11, 2) else {})


def _info(version: Version) -> Columns:
    row: Columns = {"STM_size": 3, "last_sign_added": 3, "process_mem_used": 0, "database_mem_used": 0}
    row["dictionary_size"] = 2
    return row | ({"parameters": PARAMETERS} if version >= (0, 11, 8) else {}) | {"time_enter": _TIME}


def _statistics(version: Version) -> Columns:
    text = np.frombuffer(STATISTICS.encode() + b"\0", np.int8)[None]
    row = {"id": 3, "stamp": 103.0, "data": z(text, 1) if version >= (0, 15, 0) else STATISTICS}
    return row | ({"wm_state": z(np.array([[1, 2]], np.int32), 4)} if version >= (0, 16, 2) else {})


def _admin(version: Version) -> Columns:
    row: Columns = {"version": ".".join(str(part) for part in version)}
    if version >= (0, 12, 0):
        row["preview_image"] = None
    if version >= (0, 13, 0):
        row |= {"opt_cloud": z(CLOUD, 21), "opt_ids": None, "opt_poses": None, "opt_polygons_size": 3}
        row |= {"opt_polygons": z(np.array([[1, 0, 1, 2]], np.int32), 4), "opt_tex_coords": None}
        row |= {"opt_tex_materials": None, "opt_map": None, "opt_map_x_min": None, "opt_map_y_min": None}
    if version >= (0, 17, 0):
        row["opt_ids"] = z(np.array([[1, 2, 3]], np.int32), 4)
        row["opt_poses"] = z(np.hstack([pose(i).ravel() for i in (1, 2, 3)])[None], 5)
        row["opt_map"] = z(np.array([[-1, 0], [100, 0]], np.int8), 1)
        row |= {"opt_map_x_min": -0.5, "opt_map_y_min": -1.0}
        row |= {"opt_last_localization": pose(3).tobytes(), "opt_map_resolution": 0.05}
    return row | ({"dictionary_index": b"index"} if version >= (0, 23, 0) else {}) | {"time_enter": _TIME}


def _data(node_id: int, version: Version, calibration: bytes, depth: bytes) -> Columns:
    row: Columns = {"id": node_id, "image": png(IMAGE), "depth": depth}
    if version >= (0, 22, 0):
        row["depth_confidence"] = z(np.full((48, 64), 100, np.uint8), 0)
    row |= {"calibration": calibration} | _scan(version)
    if version >= (0, 11, 10):
        row |= {"ground_cells": z(CELLS, 21), "obstacle_cells": z(CELLS[..., :2].copy(), 13)}
        row |= {"empty_cells": z(CELLS, 21)} if version >= (0, 16, 0) else {}
        row |= {"cell_size": 0.05, "view_point_x": 0.0, "view_point_y": 0.0, "view_point_z": 0.5}
    if version >= (0, 10, 1):
        row["user_data"] = z(np.frombuffer(USER_DATA, np.int8)[None], 1) if node_id == 1 else bytes(4)
    return row | {"time_enter": None}


def _scan(version: Version) -> Columns:
    scan = {"scan": z(SCAN[None], 13)}
    if version >= (0, 18, 0):
        numbers = [1, 0.5, 8, -1, 1, 0.2, 11, *T_BASE_SCAN.ravel()]
    elif version >= (0, 16, 1):
        numbers = [11, 8, 1, *T_BASE_SCAN.ravel()]
    elif version >= (0, 11, 10):
        numbers = [11, 8, *T_BASE_SCAN.ravel()]
    else:
        return {"scan_max_pts": 11} | ({"scan_max_range": 8.0} if version >= (0, 10, 7) else {}) | scan
    return scan | {"scan_info": np.array(numbers, "<f4").tobytes()}


def _images(version: Version, depth: bytes) -> dict[str, list[Columns]]:
    intrinsics: Columns = {"constant": 1 / FX}
    if version >= (0, 7, 0):
        intrinsics = {"fx": FX, "fy": FY, "cx": CX, "cy": CY}
    row = {"data": depth, **intrinsics, "local_transform": LOCAL.astype("<f4").tobytes(), "data2d": z(SCAN[None], 13)}
    row |= {"data2d_max_pts": 11} if version >= (0, 8, 11) else {}
    return {
        "Image": [{"id": i, "data": png(IMAGE), "time_enter": _TIME} for i in (1, 2)],
        "Depth": [{"id": i, **row, "time_enter": _TIME} for i in (1, 2)],
    }
