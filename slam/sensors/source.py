"""What every sensor source offers."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

from slam.camera import Camera
from slam.types import Frame


class Source(Protocol):
    """A sequence of synchronised, rectified colour and depth images; each iteration starts anew.

    A recorded source hands out every frame, however slow the reader is; only a live one may skip.
    """

    @property
    def name(self) -> str:
        """Short text for people and for the map's record of where it came from."""
        ...

    @property
    def camera(self) -> Camera:
        """Camera of every frame."""
        ...

    @property
    def live(self) -> bool:
        """False when it was recorded (or is rendered) and can be repeated."""
        ...

    def __len__(self) -> int:
        """Number of frames."""
        ...

    def __iter__(self) -> Iterator[Frame]:
        """Frames in order of their stamps; raises SourceError at the frame that can't be read."""
        ...
