"""Takes the README's pictures from the real page while and after the rendered flat is mapped.

``python -m tests.web.pictures`` writes docs/images: three stills, and the timeline with a rejected loop in motion.
"""

from __future__ import annotations

import io
import os
import re
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Literal

from PIL import Image, ImageChops
from playwright.sync_api import Page, expect, sync_playwright

from tests.web.conftest import FLAGS, PATIENCE_MS, VIEWPORT, chromium, until
from tests.web.served import SMALL_TOUR, Served
from tests.web.test_page_run import WM_AT_LEAST
from tests.web.test_page_scene import colours, wait_until
from tests.web.test_page_timeline import SCENE_AT

FOLDER = Path(__file__).parents[2] / "docs" / "images"
#: The second round has begun, so that loops are there.
LIVE_NODES = 68
MOMENTS = 32
FRAME_MS = 130
READING_MS = 1800
_SLOW = 90_000
#: Of the moving picture: 960 by 540.
_SCALE = 0.75
_SAME_SHARE = 0.0005
#: Of a still, so that text is as sharp as on the page.
_QUALITY = 95


def take() -> None:
    """Maps the flat, takes all pictures on the way, and says what was written."""
    began = time.monotonic()
    FOLDER.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CACHE_HOME"] = folder
        source = ("--source", f"{SMALL_TOUR},frames=290", "--speed", "0")
        server = Served("demo", *source, "--db", f"{folder}/flat.db", "--port", "0")
        try:
            with opened(server) as page:
                while_it_maps(page, server)
                expect(page.get_by_role("banner")).to_contain_text("finished", timeout=_SLOW)
            of_a_loop(server)
            moving(server)
        finally:
            server.close()
    print(f"{time.monotonic() - began:.0f} s")


@contextmanager
def opened(server: Served, *, theme: Literal["dark", "light"] = "dark", scale: float = 1.0) -> Iterator[Page]:
    """The page without the hints for the first visit; ``scale`` is pixels of the picture per pixel of the page."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium(), args=list(FLAGS))
        page = browser.new_page(viewport=VIEWPORT, color_scheme=theme, device_scale_factor=scale)
        page.set_default_timeout(PATIENCE_MS)
        page.add_init_script("localStorage.setItem('slamdeck.tour-seen', 'true')")
        page.goto(server.url)
        yield page
        browser.close()


def while_it_maps(page: Page, server: Served) -> None:
    """The run is held for as long as the 3D view is painted, and goes on before the picture is taken."""
    until(page, WM_AT_LEAST, LIVE_NODES - 10)
    page.keyboard.press(" ")
    expect(page.get_by_role("banner")).to_contain_text("paused")
    page.goto(f"{server.base}#/map/flat/loops")
    painted(page)
    page.keyboard.press(" ")
    expect(page.get_by_role("banner")).to_contain_text("mapping")
    still(page, "live")
    page.goto(f"{server.base}#/map/flat/params")
    painted(page)
    still(page, "params")


def of_a_loop(server: Served) -> None:
    """The review of one loop, light."""
    with opened(server, theme="light") as page:
        page.goto(f"{server.base}#/map/flat/loops")
        open_loop(page)
        painted(page)
        still(page, "loops")


def moving(server: Served) -> None:
    """The map grows along the timeline, then one of its loops is rejected."""
    with opened(server, scale=_SCALE) as page:
        page.goto(f"{server.base}#/map/flat/loops")
        painted(page)
        frames = [(frame, FRAME_MS) for frame in growing(page)]
        open_loop(page)
        frames.append((settled(page), READING_MS))
        page.keyboard.press("r")
        expect(page.locator("#effect")).to_contain_text("Rejected", timeout=_SLOW)
        frames.append((settled(page), 2 * READING_MS))
    path = FOLDER / "timeline.webp"
    durations = [duration for _, duration in frames]
    first, *others = [frame for frame, _ in frames]
    first.save(path, save_all=True, append_images=others, duration=durations, loop=0, quality=55, method=3)
    said(path)


def growing(page: Page) -> Iterator[Image.Image]:
    """The page at moments from the first update to now."""
    updates = page.evaluate("async () => (await (await fetch('api/maps/flat/timeline')).json()).ids")
    slider = page.get_by_role("slider", name="Update that is shown")
    for index in range(1, MOMENTS + 1):
        row = len(updates) * index // MOMENTS
        slider.fill(str(row))
        until(page, SCENE_AT, updates[row] if row < len(updates) else None)
        yield settled(page)


def open_loop(page: Page) -> None:
    """Opens the most doubtful of the accepted loops, with its matches."""
    page.get_by_role("row").filter(has_text="accepted").first.click()
    page.mouse.move(0, 0)
    expect(page.get_by_role("button", name=re.compile(r"^Inliers \d+"))).to_be_visible(timeout=_SLOW)


def painted(page: Page) -> None:
    """Waits until the cloud is seen in 3D and nothing moves any more."""
    wait_until(page, lambda now: colours(now) > 10_000, "the cloud has the colours of the room")
    settled(page)


def settled(page: Page) -> Image.Image:
    """The page as soon as two looks at it are the same."""
    last = shot(page)
    for _ in range(60):
        now = shot(page)
        if changed_share(last, now) < _SAME_SHARE:
            return now
        last = now
    raise AssertionError("the page does not come to rest")


def changed_share(one: Image.Image, other: Image.Image) -> float:
    """Share of the pixels that differ, 0 to 1."""
    histogram = ImageChops.difference(one, other).convert("L").histogram()
    return sum(histogram[8:]) / (one.width * one.height)


def shot(page: Page) -> Image.Image:
    return Image.open(io.BytesIO(page.screenshot(timeout=_SLOW, animations="disabled"))).convert("RGB")


def still(page: Page, name: str) -> None:
    """Writes the page as a WebP: a PNG of this size would need a palette, which shifts its colours."""
    path = FOLDER / f"{name}.webp"
    shot(page).save(path, quality=_QUALITY, method=6)
    said(path)


def said(path: Path) -> None:
    print(f"{path.relative_to(FOLDER.parents[1])}  {path.stat().st_size / 1000:.0f} kB", flush=True)


if __name__ == "__main__":
    take()
