"""Whether the words that two nodes share fit one epipolar geometry (``VhEp/``), before they are registered."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.params import Params
from slam.types import Node, Refusal


def epipolar_refusal(new: Node, old: Node, params: Params) -> Refusal | None:
    """Refuses two nodes with fewer than ``VhEp/MatchCountMin`` unique common words, or inliers among these.

    The fundamental matrix is found by RANSAC (Hartley and Zisserman 2004, algorithm 11.4).
    """
    if not params.VhEp.Enabled:
        return None
    least = params.VhEp.MatchCountMin
    _, rows_new, rows_old = np.intersect1d(_unique(new), _unique(old), return_indices=True)
    pixels = [_pixels(node)[rows] for node, rows in ((new, rows_new), (old, rows_old))]
    count, what = len(rows_new), "words in common"
    if count >= least:
        cv2.setRNGSeed(0)
        _, inliers = cv2.findFundamentalMat(
            pixels[0], pixels[1], cv2.FM_RANSAC, params.VhEp.RansacParam1, params.VhEp.RansacParam2
        )
        count, what = 0 if inliers is None else int(inliers.sum()), "words agree with an epipolar geometry"
    if count >= least:
        return None
    text = f"{count} {what}, fewer than VhEp/MatchCountMin {least}"
    return Refusal("VhEp/MatchCountMin", float(count), float(least), text)


def _unique(node: Node) -> NDArray[np.int32]:
    words, counts = np.unique(node.word_ids[node.word_ids > 0], return_counts=True)
    return np.asarray(words[counts == 1], np.int32)


def _pixels(node: Node) -> NDArray[np.float32]:
    """Pixels of the words that occur once, in the order of their ids."""
    order = np.argsort(node.word_ids, kind="stable")
    rows = order[np.searchsorted(node.word_ids[order], _unique(node))]
    return np.asarray(node.features.pixels[rows], np.float32)
