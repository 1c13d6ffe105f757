"""Rectification moves pixels as the distortion model says."""

from __future__ import annotations

import cv2
import numpy as np

from slam.camera import Camera
from slam.sensors.calibration import Calibration
from slam.sensors.rectify import make_rectifier

FREIBURG1 = Calibration(
    Camera(640, 480, 517.306408, 516.469215, 318.64304, 255.313989),
    (0.262383, -0.953104, -0.005358, 0.002628, 1.163314),
    5000.0,
)


def test_without_distortion_images_pass_untouched() -> None:
    rectifier = make_rectifier(Calibration(FREIBURG1.camera, (), 5000.0))
    image, depth = np.zeros((480, 640, 3), np.uint8), np.ones((480, 640), np.uint16)
    assert rectifier.color(image) is image
    assert rectifier.depth(depth) is depth


def test_points_land_where_the_pinhole_puts_them() -> None:
    camera = FREIBURG1.camera
    points = np.array([[-0.9, -0.6, 2.0], [0.8, 0.5, 2.0], [0.0, 0.0, 1.0], [1.0, -0.7, 2.2]])
    stored, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), camera.K, np.array(FREIBURG1.distortion))
    image = np.zeros((480, 640, 3), np.uint8)
    depth = np.zeros((480, 640), np.uint16)
    for row, (x, y) in enumerate(stored.reshape(-1, 2)):
        cv2.circle(image, (round(x), round(y)), 4, (0, 255, 0), -1)
        cv2.circle(depth, (round(x), round(y)), 4, 1000 + row, -1)
    rectifier = make_rectifier(FREIBURG1)
    color, distance = rectifier.color(image), rectifier.depth(depth)
    for row, (x, y) in enumerate(camera.project(points)):
        assert color[round(y), round(x), 1] > 200
        assert distance[round(y), round(x)] == 1000 + row
    assert set(np.unique(distance)) <= {0, 1000, 1001, 1002, 1003}, "depth is never mixed"


def test_depth_is_unknown_outside_the_stored_image() -> None:
    distance = make_rectifier(FREIBURG1).depth(np.full((480, 640), 7, np.uint16))
    assert set(np.unique(distance)) == {0, 7}
    color = make_rectifier(FREIBURG1).color(np.full((480, 640, 3), 90, np.uint8))
    assert color.min() == 90, "the rim of colour repeats its neighbours"
