"""The nodes of map files as frames, with the odometry and the key points that the files have."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.database import MapReader
from slam.errors import DatabaseError, SourceError
from slam.features.words import nothing_seen
from slam.geometry import Pose
from slam.tools.gap import Gap
from slam.types import WEIGHT_INTERMEDIATE, WEIGHT_INVALID, Features, Frame, Link, LocalGrid, Scan, Stored


class OldId(NamedTuple):
    """A node of one of several files: number of the file, from 0, and its id there."""

    file: int
    node_id: int


@dataclass(frozen=True, slots=True)
class ImageUse:
    """Which images are decoded, where they are stored; a node without stored key points needs its own in any case.

    Attributes:
        color: of every node.
        depth: of every node.
        for_clouds: the depth of nodes without a stored cloud.
        for_grids: the depth of nodes without a stored local grid.
        kept: whether the new map gets the images that the files have.
    """

    color: bool = True
    depth: bool = True
    for_clouds: bool = True
    for_grids: bool = True
    kept: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Replay:
    """The ordinary nodes of map files, file by file and in the order of their ids.

    Intermediate nodes only lead from one ordinary node to the next; merged and dropped ones are left out.

    Attributes:
        readers: of the files.
        with_features: whether frames bring the key points that were stored; else they are found anew.
        with_words: whether those of the first file keep their words; words of several files would not be the same.
        images: which of them are decoded, and kept.
        last_id: of the nodes that are replayed; None for all.
        ids: which node of which file each frame is, by the frame's index; filled while the frames are read.
        unreadable: images that could not be decoded, a text for each; likewise.
    """

    readers: Sequence[MapReader]
    with_features: bool = True
    with_words: bool = True
    images: ImageUse = field(default_factory=ImageUse)
    last_id: int | None = None
    ids: list[OldId] = field(default_factory=list)
    unreadable: list[str] = field(default_factory=list)

    @property
    def name(self) -> str:
        """The files' names."""
        return " ".join(reader.path.name for reader in self.readers)

    @property
    def camera(self) -> Camera:
        """The first camera of the first file; SourceError where none has one."""
        return _first_camera(self.readers[0])

    @property
    def live(self) -> bool:
        """It can be repeated."""
        return False

    def __len__(self) -> int:
        """Number of nodes that are replayed."""
        ordinary = (table.ids[table.weights > WEIGHT_INTERMEDIATE] for table in (one.nodes() for one in self.readers))
        return sum(sum(self._is_wanted(node_id) for node_id in ids.tolist()) for ids in ordinary)

    def _is_wanted(self, node_id: int) -> bool:
        return self.last_id is None or node_id <= self.last_id

    def __iter__(self) -> Iterator[Frame]:
        """Each node with all that its file has of it.

        Raises:
            SourceError: no node of a file has a camera.
            DatabaseError: a file can't be read.
        """
        self.ids.clear()
        self.unreadable.clear()
        for file, reader in enumerate(self.readers):
            yield from self._frames(file, reader)

    def _frames(self, file: int, reader: MapReader) -> Iterator[Frame]:
        table, links, cameras = reader.nodes(), reader.links(), reader.first_cameras()
        camera, gap, alone = _first_camera(reader), Gap(links), _constraints(links)
        for row, node_id in enumerate(table.ids.tolist()):
            weight = int(table.weights[row])
            if weight <= WEIGHT_INVALID or not self._is_wanted(node_id):
                continue
            covariance = gap.to(node_id, ordinary=weight > WEIGHT_INTERMEDIATE)
            if weight <= WEIGHT_INTERMEDIATE:
                continue
            camera = cameras.get(node_id, camera)
            of_node, of_data = reader.stored_columns(node_id, images=self.images.kept)
            features, word_ids = self._features(reader, node_id, camera)
            scan = reader.scan(node_id) if "scan" in of_data else None
            grid = reader.local_grid(node_id) if "cell_size" in of_data else None
            image, depth = self._images(reader, node_id, self._decoded(features, scan, grid))
            features = nothing_seen() if features is None and not image.size else features
            known = reader.words(np.unique(word_ids).tolist()) if self.with_words and file == 0 else None
            # Words of dropped nodes may be gone from the dictionary.
            whole = known is not None and len(known) == len(np.unique(word_ids))
            stored = Stored(
                T_odom_base=_known(table.T_odom[row]),
                covariance=covariance,
                features=features,
                words=len(word_ids),
                word_ids=word_ids if whole else None,
                word_descriptors=known.descriptors if whole and known is not None else None,
                constraints=tuple(alone.get(node_id, ())),
                scan=scan,
                grid=grid,
                node=of_node,
                # What has no depth image gets none, whatever the engine had in its place.
                data={"depth": None, **({} if self.images.kept else {"image": None}), **of_data},
            )
            T_world_base = _known(table.T_world[row])
            self.ids.append(OldId(file, node_id))
            index, stamp = len(self.ids) - 1, float(table.stamps[row])
            yield Frame(index, stamp, image, depth, camera, T_world_base, stored=stored)

    def _decoded(self, features: Features | None, scan: Scan | None, grid: LocalGrid | None) -> tuple[bool, bool]:
        """Whether colour and depth of a node that brings this are decoded."""
        wanted, anew = self.images, features is None
        depth = wanted.depth or (wanted.for_clouds and scan is None) or (wanted.for_grids and grid is None)
        return wanted.color or anew, depth or anew

    def _images(
        self, reader: MapReader, node_id: int, decoded: tuple[bool, bool]
    ) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """Colour and depth: of no pixels without an image, zeros where only the depth is missing."""
        node = reader.node(node_id)
        image, depth = np.zeros((0, 0, 3), np.uint8), np.zeros((0, 0), np.float32)
        try:
            image = reader.image_bgr(node_id) if decoded[0] and node.image_bytes else image
            depth = np.zeros(image.shape[:2], np.float32)
            depth = reader.depth_m(node_id) if decoded[1] and node.depth_bytes and node.image_bytes else depth
        except DatabaseError as error:
            self.unreadable.append(str(error))
        return image, depth

    def _features(self, reader: MapReader, node_id: int, camera: Camera) -> tuple[Features | None, NDArray[np.int32]]:
        """Key points of the first camera, words first and the strongest first, and the ids of the words.

        None where they are to be found in the image.
        """
        none = np.zeros(0, np.int32)
        features, word_ids = reader.features(node_id) if self.with_features else (nothing_seen(), none)
        if not len(features) or not features.descriptors.shape[1]:
            return None, none
        mine = np.flatnonzero(features.pixels[:, 0] < camera.width) if camera.width else np.arange(len(features))
        is_word = word_ids[mine] > 0
        order = mine[np.lexsort((-features.responses[mine], ~is_word))]
        return features.take(order), word_ids[order[: int(is_word.sum())]]


def _first_camera(reader: MapReader) -> Camera:
    cameras = reader.first_cameras()
    if not cameras:
        raise SourceError(f"{reader.path}: no node has a camera, there is nothing that could be mapped again")
    return cameras[min(cameras)]


def _constraints(links: Sequence[Link]) -> dict[int, list[Link]]:
    """Priors, gravity and sightings of landmarks, by node."""
    found: dict[int, list[Link]] = {}
    for link in links:
        if (link.from_id == link.to_id or link.to_id < 0) and link.T_from_to is not None:
            found.setdefault(link.from_id, []).append(link)
    return found


def _known(T: Pose) -> Pose | None:
    return T if np.isfinite(T).all() else None
