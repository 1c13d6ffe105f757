"""Images of a node, encoded on a thread of their own while the update that the node belongs to goes on."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from slam.database.images import encode_color, encode_depth
from slam.params import Params

T = TypeVar("T", bound=np.generic)


class ImageEncoder:
    """Encodes images in advance; the bytes are the same either way.

    Only the encoding is done elsewhere: what it gave goes into the file in the one transaction of its node.
    """

    def __init__(self) -> None:
        self._worker = ThreadPoolExecutor(max_workers=1, thread_name_prefix="images")
        self._begun: dict[int, tuple[NDArray[np.generic], str, Future[bytes]]] = {}

    def begin(self, image_bgr: NDArray[np.uint8], depth_m: NDArray[np.float32], params: Params) -> None:
        """Starts with the images of the node that is stored next; they must not be changed."""
        self._begun.clear()
        color, depth = params.Mem.ImageCompressionFormat, params.Mem.DepthCompressionFormat
        self._begun[id(image_bgr)] = (image_bgr, color, self._worker.submit(encode_color, image_bgr, color))
        self._begun[id(depth_m)] = (depth_m, depth, self._worker.submit(encode_depth, depth_m, depth))

    def color(self, image_bgr: NDArray[np.uint8], extension: str) -> bytes:
        """As ``encode_color``; waits for it where it was begun."""
        return self._taken(image_bgr, extension) or encode_color(image_bgr, extension)

    def depth(self, depth_m: NDArray[np.float32], extension: str) -> bytes:
        """As ``encode_depth``; waits for it where it was begun."""
        return self._taken(depth_m, extension) or encode_depth(depth_m, extension)

    def close(self) -> None:
        """Ends the thread."""
        self._worker.shutdown(wait=True, cancel_futures=True)
        self._begun.clear()

    def _taken(self, image: NDArray[T], extension: str) -> bytes | None:
        begun, by, encoded = self._begun.pop(id(image), (None, "", None))
        return encoded.result() if begun is image and by == extension and encoded is not None else None
