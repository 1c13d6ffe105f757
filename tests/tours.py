"""Frames of the rendered tour, small and far apart so that whole maps take seconds."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from slam.geometry import Pose
from slam.params import Params
from slam.sensors import open_source
from slam.slam import Slam
from slam.types import Frame, Update

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
