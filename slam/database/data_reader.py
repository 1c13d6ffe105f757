"""Reading what is stored of single nodes: images, clouds, key points, sensors, local grids."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.database import confidence_rows, data_rows, sensor_rows
from slam.database.faults import reason_of
from slam.database.feature_rows import read_features
from slam.database.file_reader import FileReader
from slam.database.guard import LARGE_VALUE
from slam.database.image_size import check_size
from slam.database.images import decode_color, decode_depth
from slam.database.scans import StoredScan
from slam.database.sensor_values import NodeSensors
from slam.database.stored_rows import read_stored_columns
from slam.errors import DamagedRowError, DatabaseError
from slam.types import Features, LocalGrid, Scan


class DataReader(FileReader):
    """The data of a node, which may be large and is read when it is asked for.

    Raises (every method):
        DatabaseError: the node has none; a DamagedRowError where it makes no sense.
    """

    def image(self, node_id: int) -> bytes:
        """The colour image as stored (JPEG or PNG)."""
        with self._reading(f"reading the image of node {node_id}", LARGE_VALUE) as connection:
            return data_rows.read_image(connection, node_id)

    def image_file(self, node_id: int) -> bytes:
        """The same for another program to decode: refused when its header claims a size that no camera has."""
        blob = self.image(node_id)
        with _about(self.path, node_id):
            check_size(blob, "colour")
        return blob

    def image_bgr(self, node_id: int) -> NDArray[np.uint8]:
        """The colour image (H, W, 3), blue green red."""
        blob = self.image(node_id)
        with _about(self.path, node_id):
            return decode_color(blob)

    def depth(self, node_id: int) -> bytes:
        """The depth image as stored (RVL or PNG)."""
        with self._reading(f"reading the depth of node {node_id}", LARGE_VALUE) as connection:
            return data_rows.read_depth(connection, node_id)

    def depth_m(self, node_id: int) -> NDArray[np.float32]:
        """The depth image (H, W) in metres, 0 where unknown."""
        blob = self.depth(node_id)
        with _about(self.path, node_id):
            return decode_depth(blob)

    def camera(self, node_id: int) -> Camera:
        """The first camera of a node."""
        return self.cameras(node_id)[0]

    def has_confidence(self, node_id: int) -> bool:
        """Whether it is stored how sure the camera was of the depth of a node."""
        with self._reading(f"reading node {node_id}") as connection:
            return confidence_rows.has_confidence(connection, node_id)

    def confidence(self, node_id: int) -> NDArray[np.uint8] | None:
        """How sure the camera was of each pixel of depth (H, W), 0 to 100; None where that is not stored."""
        doing = f"reading the confidence of node {node_id}"
        with self._reading(doing, LARGE_VALUE) as connection, _about(self.path, node_id):
            return confidence_rows.read_confidence(connection, node_id)

    def cameras(self, node_id: int) -> tuple[Camera, ...]:
        """All cameras of a node; the image has one tile for each, left to right."""
        with self._reading(f"reading the calibration of node {node_id}") as connection, _about(self.path, node_id):
            return data_rows.read_cameras(connection, node_id)

    def baselines(self, node_id: int) -> tuple[float, ...]:
        """Baseline in metres of each stereo pair of a node, whose right images are where depth is of others."""
        with self._reading(f"reading the calibration of node {node_id}") as connection, _about(self.path, node_id):
            return data_rows.read_baselines(connection, node_id)

    def right_bgr(self, node_id: int) -> NDArray[np.uint8]:
        """The right image (H, W, 3) of a node of a stereo camera; of several, one tile for each."""
        blob = self.depth(node_id)
        with _about(self.path, node_id):
            return decode_color(blob)

    def sensors(self, node_id: int) -> NodeSensors:
        """Velocity, GPS, environmental sensors, global descriptors and user data of a node."""
        with self._reading(f"reading the sensors of node {node_id}") as connection, _about(self.path, node_id):
            return sensor_rows.read_sensors(connection, node_id)

    def features(self, node_id: int) -> tuple[Features, NDArray[np.int32]]:
        """Key points of a node, in the order they were written, and their word ids (N,)."""
        doing = f"reading the key points of node {node_id}"
        with self._reading(doing) as connection, _about(self.path, node_id, "Feature"):
            return read_features(connection, node_id)

    def seen(self, node_ids: Iterable[int]) -> list[tuple[Features, NDArray[np.int32], Scan | None]]:
        """What ``features`` and ``scan`` have of several nodes, through one connection."""
        found = []
        with self._reading("reading nodes", LARGE_VALUE) as connection:
            for node_id in node_ids:
                with _about(self.path, node_id, "Feature"):
                    features, word_ids = read_features(connection, node_id)
                with _about(self.path, node_id):
                    found.append((features, word_ids, data_rows.read_scan(connection, node_id)))
        return found

    def scan(self, node_id: int) -> Scan | None:
        """The cloud of a node in its base frame; None when it has none."""
        with (
            self._reading(f"reading the cloud of node {node_id}", LARGE_VALUE) as connection,
            _about(self.path, node_id),
        ):
            return data_rows.read_scan(connection, node_id)

    def stored_scan(self, node_id: int) -> StoredScan | None:
        """The same with intensities, colours, and what is known of the scanner."""
        doing = f"reading the cloud of node {node_id}"
        with self._reading(doing, LARGE_VALUE) as connection, _about(self.path, node_id):
            return data_rows.read_stored_scan(connection, node_id)

    def stored_columns(self, node_id: int, *, images: bool = True) -> tuple[dict[str, object], dict[str, object]]:
        """What a replay hands on of a node, as it is: columns of the tables Node and Data by name."""
        with self._reading(f"reading node {node_id}") as connection:
            return read_stored_columns(connection, node_id, images=images)

    def local_grid(self, node_id: int) -> LocalGrid | None:
        """The local grid of a node; None when it has none."""
        doing = f"reading the local grid of node {node_id}"
        with self._reading(doing, LARGE_VALUE) as connection, _about(self.path, node_id):
            return data_rows.read_local_grid(connection, node_id)


@contextmanager
def _about(path: Path, node_id: int, table: str = "Data") -> Iterator[None]:
    """Say in an error which row of which file it is about."""
    try:
        yield
    except (DatabaseError, ValueError, TypeError, OverflowError) as error:
        raise DamagedRowError(table, str(node_id), reason_of(error), f"{path}: ") from error
