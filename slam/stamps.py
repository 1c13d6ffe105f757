"""Which moments of two recordings are the same."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def pair_nearest(first: NDArray[np.float64], second: NDArray[np.float64], within_s: float) -> NDArray[np.intp]:
    """One-to-one pairs of ascending stamps in seconds, (P, 2) rows of (first, second), ascending in first.

    The closest pairs are made first, as the TUM benchmark's associate.py does; equal distances go to the earlier
    stamps, so that the outcome is unique. No pair is farther apart than ``within_s``.
    """
    low = np.searchsorted(second, first - within_s, side="left")
    high = np.searchsorted(second, first + within_s, side="right")
    counts = high - low
    rows = np.repeat(np.arange(len(first)), counts)
    columns = np.arange(len(rows)) + np.repeat(low - (np.cumsum(counts) - counts), counts)
    order = np.lexsort((columns, rows, np.abs(first[rows] - second[columns])))
    partner: dict[int, int] = {}
    taken: set[int] = set()
    for row, column in zip(rows[order].tolist(), columns[order].tolist(), strict=True):
        if row not in partner and column not in taken:
            partner[row] = column
            taken.add(column)
    return np.array(sorted(partner.items()), dtype=np.intp).reshape(-1, 2)
