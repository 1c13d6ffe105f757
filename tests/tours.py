"""Frames of the rendered tour, small and far apart so that whole maps take seconds."""

from __future__ import annotations

import atexit
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp

import numpy as np

from slam.database import MapWriter
from slam.geometry import Pose
from slam.params import Params
from slam.sensors import open_source
from slam.slam import Slam
from slam.types import Candidate, Frame, Update

#: Every frame becomes a node; 0.4 m apart.
EVERY = Params().changed({"Rtabmap/DetectionRate": 0.0})
#: Frames of one lap and a little more of ``sparse``: the second lap begins at 81.
LAP = 81


@cache
def sparse(count: int = 95) -> tuple[Frame, ...]:
    """The tour at 320x240 and 2 Hz: a lap is 81 frames, and the start comes into view again from frame 80 on."""
    return tuple(open_source(f"tour:width=320,height=240,fps=2,frames={count}"))


@cache
def dense(count: int = 24) -> tuple[Frame, ...]:
    """The start of the tour at 320x240 and 15 Hz."""
    return tuple(open_source(f"tour:width=320,height=240,fps=15,frames={count}"))


def blank(frame: Frame) -> Frame:
    """The frame with the lid on the lens: grey, without depth."""
    return replace(frame, image_bgr=np.full_like(frame.image_bgr, 90), depth_m=np.zeros_like(frame.depth_m))


def covered(frames: Sequence[Frame], which: Iterable[int]) -> list[Frame]:
    """These frames with some of them blank."""
    chosen = set(which)
    return [blank(frame) if k in chosen else frame for k, frame in enumerate(frames)]


def fed(slam: Slam, frames: Iterable[Frame]) -> list[Update]:
    """What the engine makes of frames, one after the other."""
    return [slam.process(frame) for frame in frames]


def truth(frames: Iterable[Frame]) -> list[Pose]:
    """True poses of frames; the tour knows them all."""
    poses = [frame.T_world_base for frame in frames]
    return [pose for pose in poses if pose is not None]


def there_and_back(count: int, *, first: int = 0) -> list[Frame]:
    """The sparse tour up to a frame and backwards to the start again, with stamps that go on."""
    way = [*sparse()[first : first + count], *sparse()[first : first + count - 1][::-1]]
    start = way[0].stamp
    return [replace(frame, index=k, stamp=start + 0.5 * k) for k, frame in enumerate(way)]


@dataclass(frozen=True, slots=True, eq=False)
class Mapped:
    """A whole run that ended in order: the engine, its updates, and the closed map file."""

    slam: Slam
    updates: tuple[Update, ...]
    path: Path

    @property
    def candidates(self) -> list[Candidate]:
        """All loop closures that were looked at."""
        return [candidate for update in self.updates for candidate in update.candidates]


@cache
def mapped(memory_thr: int) -> Mapped:
    """The sparse tour with its loops, as a map file; with ``memory_thr`` nodes leave working memory and come back."""
    folder = Path(mkdtemp(prefix="slamdeck-tour-"))
    atexit.register(rmtree, folder, ignore_errors=True)
    params = EVERY.changed({"Rtabmap/MemoryThr": memory_thr})
    path = folder / "tour.db"
    slam = Slam(params, MapWriter.create(path, params, seed=3, source="tour:"), seed=3, source="tour:")
    updates = fed(slam, sparse())
    slam.close()
    return Mapped(slam, tuple(updates), path)


@cache
def saved(memory_thr: int, count: int = 18) -> Path:
    """A closed map file of the first frames of the sparse tour, from the source "there"."""
    folder = Path(mkdtemp(prefix="slamdeck-saved-"))
    atexit.register(rmtree, folder, ignore_errors=True)
    params = EVERY.changed({"Rtabmap/MemoryThr": memory_thr})
    slam = Slam(params, MapWriter.create(folder / "map.db", params, seed=0, source="there"), source="there")
    fed(slam, sparse()[:count])
    slam.close()
    return folder / "map.db"
