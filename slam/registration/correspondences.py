"""Which key points of one view are which pixels of another: by descriptors, or by optical flow."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.features.light_glue import LIGHT_GLUE, match_light_glue
from slam.features.match import match_all, match_near
from slam.geometry import Pose, inverse, transform
from slam.params import Params
from slam.registration.view import View
from slam.types import Features, Images


@dataclass(frozen=True, slots=True, eq=False)
class Correspondences:
    """Rows that belong together.

    Attributes:
        rows: (M, 2) int32 rows (first view's features, ``features_to``); the first have depth.
        features_to: what the second column counts; with optical flow the first view's points, where the second
            view shows them.
    """

    rows: NDArray[np.int32]
    features_to: Features


class Matching:
    """``Vis/CorType`` 0: descriptors, around where a guess expects them; without one by ``Vis/CorNNType``."""

    def between(
        self, view_from: View, view_to: View, guess: Pose | None, radius: float, params: Params
    ) -> Correspondences:
        """Matches of the first view's points that have depth; ``radius`` in pixels around the guess."""
        features, to = view_from.features, view_to.features
        with_depth = np.flatnonzero(np.isfinite(features.points_base[:, 0]))
        descriptors = features.descriptors[with_depth]
        if guess is None and params.Vis.CorNNType == LIGHT_GLUE:
            matches = match_light_glue(features.take(with_depth), view_from.camera, to, view_to.camera, params)
        elif guess is None:
            matches = match_all(descriptors, to.descriptors, ratio=params.Vis.CorNNDR)
        else:
            points = features.points_base.astype(np.float64)[with_depth]
            matches = match_near(
                _predicted(points, guess, view_to.camera).astype(np.float32),
                descriptors,
                to.pixels,
                to.descriptors,
                radius=radius,
                ratio=params.Vis.CorNNDR,
            )
        return Correspondences(np.column_stack([with_depth[matches[:, 0]], matches[:, 1]]).astype(np.int32), to)


class OpticalFlow:
    """Points followed from image to image by pyramidal Lucas-Kanade (``Vis/CorType`` 1); both images are needed."""

    def between(
        self, view_from: View, view_to: View, guess: Pose | None, radius: float, params: Params
    ) -> Correspondences:
        """Points that were found again; ``radius`` is not used: the pyramid says how far one can move."""
        del radius
        assert view_from.images is not None
        assert view_to.images is not None
        features, vis = view_from.features, params.Vis
        rows = np.flatnonzero(np.isfinite(features.points_base[:, 0]))
        if len(rows) == 0:
            return Correspondences(np.zeros((0, 2), np.int32), features)
        pixels = features.pixels[rows]
        expected = pixels
        if guess is not None:
            points = features.points_base.astype(np.float64)[rows]
            predicted = _predicted(points, guess, view_to.camera).astype(np.float32)
            expected = np.where(np.isfinite(predicted), predicted, pixels)
        tracked, status, error = cv2.calcOpticalFlowPyrLK(
            view_from.images.gray,
            view_to.images.gray,
            pixels,
            expected.copy(),
            winSize=(vis.CorFlowWinSize, vis.CorFlowWinSize),
            maxLevel=vis.CorFlowMaxLevel,
            criteria=(cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, vis.CorFlowIterations, vis.CorFlowEps),
            flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
        )
        found = np.asarray(tracked, np.float32)
        size = (view_to.camera.width - 1, view_to.camera.height - 1)
        good = (np.ravel(status) > 0) & (np.ravel(error) <= vis.CorFlowErrorThreshold)
        good &= ((found >= 0) & (found <= size)).all(axis=1)
        rows, found = rows[good].astype(np.int32), found[good]
        pixels_to, points_to = np.zeros_like(features.pixels), np.full_like(features.points_base, np.nan)
        pixels_to[rows], points_to[rows] = found, _measured(found, view_to.images, view_to.camera)
        return Correspondences(
            np.column_stack([rows, rows]), replace(features, pixels=pixels_to, points_base=points_to)
        )


def _predicted(points_from: NDArray[np.float64], T_from_to: Pose, camera: Camera) -> NDArray[np.float64]:
    """Pixels (N, 2) where the second view should see points of the first; NaN behind it."""
    return camera.project(transform(inverse(T_from_to @ camera.T_base_cam), points_from))


def _measured(pixels: NDArray[np.float32], images: Images, camera: Camera) -> NDArray[np.float32]:
    """(N, 3) points of the base frame at the pixels nearest to these; NaN without depth."""
    scale = images.depth_m.shape[1] / camera.width
    u, v = np.rint((pixels + 0.5) * scale - 0.5).astype(np.int64).T
    depth = images.depth_m[v.clip(0, images.depth_m.shape[0] - 1), u.clip(0, images.depth_m.shape[1] - 1)]
    points_cam = camera.unproject(pixels, np.where(depth > 0, depth, np.nan))
    return transform(camera.T_base_cam, points_cam).astype(np.float32)
