"""What everything in the 3D view is coloured like, in both themes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from server.browse.node_values import scale
from server.scene.placed import PlacedGraph
from server.scene.tone import Rgb
from server.schemas.scene import Colouring

Colours = NDArray[np.uint8]

#: Colourings that need no numbers of their own.
NAMED = ("memory", "session", "time", "weight")

#: Sessions, in turn: far apart in hue, and none of them red like a loop.
_SESSIONS = np.array(
    [[76, 201, 240], [255, 181, 71], [61, 220, 132], [177, 140, 255], [255, 226, 92], [94, 234, 212], [240, 140, 90]],
    dtype=np.uint8,
)
#: Support points of the scale from old to new, and from light to heavy (after viridis, without its darkest end).
_SCALE = np.array([[72, 90, 160], [45, 140, 160], [40, 185, 135], [150, 215, 75], [253, 231, 76]], dtype=np.float64)


@dataclass(frozen=True, slots=True)
class Theme:
    """Colours of one theme, red green blue, as they shall look."""

    background: tuple[Rgb, Rgb]
    ground: tuple[Rgb, Rgb]
    stm: Rgb
    wm: Rgb
    ltm: Rgb
    neighbor: Rgb
    loop: Rgb
    proximity: Rgb
    in_time: Rgb
    user: Rgb
    coming: Rgb
    overlay_from: Rgb
    overlay_to: Rgb
    virtual: Rgb
    refused: Rgb
    odometry: Rgb
    truth: Rgb
    frustum: Rgb
    newest: Rgb
    selected: Rgb
    free: Rgb
    occupied: Rgb
    frontier: Rgb


DARK = Theme(
    background=((22, 26, 33), (11, 13, 17)),
    ground=((34, 39, 48), (48, 55, 67)),
    stm=(255, 181, 71),
    wm=(61, 220, 132),
    ltm=(122, 136, 160),
    neighbor=(128, 142, 166),
    loop=(255, 82, 133),
    proximity=(255, 150, 190),
    in_time=(255, 190, 150),
    user=(177, 140, 255),
    coming=(94, 234, 212),
    overlay_from=(255, 150, 60),
    overlay_to=(70, 190, 255),
    virtual=(90, 100, 120),
    refused=(150, 158, 172),
    odometry=(84, 116, 230),
    truth=(226, 206, 120),
    frustum=(92, 112, 140),
    newest=(255, 181, 71),
    selected=(255, 255, 255),
    free=(62, 74, 96),
    occupied=(226, 233, 245),
    frontier=(70, 190, 255),
)
LIGHT = Theme(
    background=((255, 255, 255), (236, 240, 245)),
    ground=((222, 227, 234), (203, 210, 220)),
    stm=(224, 134, 10),
    wm=(22, 148, 82),
    ltm=(138, 150, 172),
    neighbor=(112, 124, 146),
    loop=(214, 30, 96),
    proximity=(236, 110, 160),
    in_time=(226, 120, 90),
    user=(120, 80, 220),
    coming=(0, 138, 128),
    overlay_from=(224, 96, 0),
    overlay_to=(0, 110, 200),
    virtual=(170, 178, 192),
    refused=(120, 128, 142),
    odometry=(60, 90, 215),
    truth=(150, 116, 10),
    frustum=(120, 138, 165),
    newest=(224, 134, 10),
    selected=(12, 16, 24),
    free=(246, 248, 251),
    occupied=(40, 46, 58),
    frontier=(0, 110, 200),
)


def theme(dark: bool) -> Theme:
    """The colours of the dark or of the light theme."""
    return DARK if dark else LIGHT


def node_colours(graph: PlacedGraph, how: Colouring, look: Theme, values: Mapping[int, float] | None = None) -> Colours:
    """Colour (N, 3) of each node; by ``values`` (id -> number) where they are given, grey where there is none."""
    if values is not None:
        low, high = scale(values)
        numbers = np.array([values.get(i, np.nan) for i in graph.ids.tolist()], np.float64)
        known = np.isfinite(numbers)
        colours = _on_scale(np.where(known, numbers, low).clip(low, high), (low, high))
        colours[~known] = look.refused
        return colours
    if how == "session":
        order = np.unique(graph.map_ids, return_inverse=True)[1]
        return np.asarray(_SESSIONS[order % len(_SESSIONS)])
    if how == "time":
        return _on_scale(np.arange(len(graph), dtype=np.float64))
    if how == "weight":
        return _on_scale(np.log2(1.0 + graph.weights.clip(min=0)))
    return np.asarray(np.array([look.stm, look.wm, look.ltm], dtype=np.uint8)[graph.tiers])


def _on_scale(values: NDArray[np.float64], ends: tuple[float, float] | None = None) -> Colours:
    """Values (N,), the least to the greatest or from end to end, as colours (N, 3) of the scale in 256 steps."""
    least, greatest = ends or ((values.min(), values.max()) if len(values) else (0.0, 0.0))
    level = np.rint(255.0 * (values - least) / max(greatest - least, 1e-9))
    place = level / 255.0 * (len(_SCALE) - 1)
    channels = [np.interp(place, np.arange(len(_SCALE)), _SCALE[:, channel]) for channel in range(3)]
    return np.asarray(np.rint(np.column_stack(channels)), dtype=np.uint8)
