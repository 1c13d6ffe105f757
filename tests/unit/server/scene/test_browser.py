"""What a person sees, in a real browser."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from server.browse.map_view import MapView
from server.catalog import MapFile
from server.scene.colours import DARK, LIGHT, Theme
from server.scene.scene import MapScene
from server.schemas.scene import SceneChange
from tests.web.conftest import FLAGS

_CHROMIUM = shutil.which("chromium")
_SIZE = {"width": 640, "height": 480}


@pytest.fixture
def page() -> Any:
    if _CHROMIUM is None:
        pytest.skip("needs the program chromium")
    playwright = pytest.importorskip("playwright.sync_api", reason="needs the package playwright")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=_CHROMIUM, args=list(FLAGS))
        yield browser.new_page(viewport=_SIZE)
        browser.close()


def picture(page: Any) -> NDArray[np.int64]:
    """The page as pixels (H, W, 3), red first."""
    data = np.frombuffer(page.screenshot(timeout=120_000), dtype=np.uint8)
    decoded = cv2.imdecode(data, cv2.IMREAD_COLOR)
    assert decoded is not None
    return decoded[:, :, ::-1].astype(np.int64)


def until_shown(page: Any, seen: Callable[[NDArray[np.int64]], Any]) -> NDArray[np.int64]:
    """The picture once something is to be seen in it."""
    end = time.monotonic() + 120
    while not seen(image := picture(page)):
        assert time.monotonic() < end, "it is not to be seen"
        time.sleep(0.5)
    return image


def colourful(image: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Where the picture is neither background nor lines on the ground."""
    return np.asarray(np.ptp(image, axis=2) > 60)


def is_before(image: NDArray[np.int64], theme: Theme) -> bool:
    """Whether the background is that of a theme; it may come a moment after the clouds."""
    return bool(np.abs(image[2, 2] - theme.background[0]).max() < 12)


def test_the_map_is_seen_without_any_control_of_viser_in_both_themes(room_map: Path, page: Any) -> None:
    scene = MapScene(MapView(MapFile("room", "room", room_map)), print)
    try:
        page.goto(f"http://127.0.0.1:{scene.port}/")
        dark = until_shown(page, lambda image: colourful(image).mean() > 0.2 and is_before(image, DARK))
        # All of the map is in the picture: nothing of it touches the edges.
        inside = np.zeros(dark.shape[:2], dtype=bool)
        inside[4:-4, 4:-4] = True
        assert not colourful(dark)[~inside].any()
        scene.change(SceneChange(dark=False))
        light = until_shown(page, lambda image: is_before(image, LIGHT))
        assert colourful(light).mean() > 0.2
        panels = page.locator(".mantine-Paper-root")
        assert all(not panels.nth(i).is_visible() for i in range(panels.count()))
    finally:
        # viser leaves sockets open that a browser still holds.
        page.goto("about:blank")
        scene.close()
