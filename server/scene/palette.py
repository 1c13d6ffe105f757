"""Colours of the 3D view: middle tones that can be read on the page's dark ground and on its light one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slam.types import LinkType, Tier

Rgb = tuple[int, int, int]
Colors = NDArray[np.uint8]

TIERS: dict[Tier, Rgb] = {Tier.STM: (255, 158, 44), Tier.WM: (38, 190, 120), Tier.LTM: (118, 134, 156)}
LOOP: Rgb = (240, 62, 128)
LINKS: dict[LinkType, Rgb] = {LinkType.NEIGHBOR: (120, 136, 156), LinkType.NEIGHBOR_MERGED: (120, 136, 156)}
OTHER_LINK: Rgb = (150, 120, 200)
REFUSED: Rgb = (150, 156, 166)
ODOMETRY: Rgb = (98, 122, 240)
TRUTH: Rgb = (190, 172, 40)
CAMERA: Rgb = (255, 158, 44)
LOST: Rgb = (232, 72, 72)
SELECTED: Rgb = (40, 170, 245)
FRUSTA: Rgb = (120, 136, 156)
FLOOR: Rgb = (128, 140, 155)

#: One colour for each session, in turn.
_SESSIONS: tuple[Rgb, ...] = (
    (38, 190, 120),
    (255, 158, 44),
    (98, 122, 240),
    (240, 62, 128),
    (30, 178, 196),
    (168, 106, 230),
    (190, 172, 40),
    (118, 134, 156),
)
#: From low to high: the middle of the viridis map, whose ends vanish on a dark or on a light ground.
_RAMP = np.array([(70, 95, 180), (40, 150, 160), (60, 185, 110), (160, 200, 60), (250, 200, 50)], dtype=np.float64)


def by_session(map_ids: NDArray[np.integer]) -> Colors:
    """Colours (N, 3) of session numbers (N,)."""
    return np.asarray(np.array(_SESSIONS, dtype=np.uint8)[map_ids % len(_SESSIONS)])


def by_value(values: NDArray[np.floating]) -> Colors:
    """Colours (N, 3) of values (N,), the lowest blue, the highest yellow."""
    if not len(values):
        return np.zeros((0, 3), dtype=np.uint8)
    low, high = float(values.min()), float(values.max())
    share = (values - low) / (high - low) if high > low else np.zeros(len(values))
    stops = np.linspace(0, 1, len(_RAMP))
    return np.column_stack([np.interp(share, stops, _RAMP[:, k]) for k in range(3)]).round().astype(np.uint8)
