"""The optional tests of a visual registration, each off at 0."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.params import Params
from slam.types import Refusal

Array = NDArray[np.float64]


def missed(
    points_from: Array, pixels_to: NDArray[np.float32], covariance: Array, camera: Camera, params: Params
) -> Refusal | None:
    """The first test that the inliers miss, None when they pass all.

    Args:
        points_from: (N, 3) inliers in the first view's base frame, metres.
        pixels_to: (N, 2) where the second view sees them.
        covariance: (6, 6) of the transform.
        camera: of the second view.
        params: Vis/MeanInliersDistance, Vis/MinInliersDistribution and Vis/PnPMaxVariance are read.
    """
    vis = params.Vis
    distance, spread, variance = mean_distance(points_from), distribution(pixels_to, camera), float(covariance[0, 0])
    if 0 < vis.MeanInliersDistance < distance:
        text = f"inliers are {distance:.2f} m away in the mean, farther than Vis/MeanInliersDistance"
        text += f" {vis.MeanInliersDistance:g}"
        return Refusal("Vis/MeanInliersDistance", distance, vis.MeanInliersDistance, text)
    if spread < vis.MinInliersDistribution:
        text = f"inliers spread {spread:.4f} over the image, less than Vis/MinInliersDistribution"
        text += f" {vis.MinInliersDistribution:g}"
        return Refusal("Vis/MinInliersDistribution", spread, vis.MinInliersDistribution, text)
    if 0 < vis.PnPMaxVariance < variance:
        text = f"linear variance {variance:.3g} is above Vis/PnPMaxVariance {vis.PnPMaxVariance:g}"
        return Refusal("Vis/PnPMaxVariance", variance, vis.PnPMaxVariance, text)
    return None


def mean_distance(points: Array) -> float:
    """Mean distance in metres of points (N, 3) from the origin of their frame."""
    return float(np.linalg.norm(points, axis=1).mean())


def distribution(pixels: NDArray[np.float32], camera: Camera) -> float:
    """The smaller variance of the principal axes of pixels (N, 2), in an image whose sides are 1."""
    unit = pixels.astype(np.float64) / (camera.width, camera.height)
    centred = unit - unit.mean(axis=0)
    return float(np.linalg.eigvalsh(centred.T @ centred / len(unit))[0])
