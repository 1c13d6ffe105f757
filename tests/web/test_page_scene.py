"""See the graph in 3D, switch its layers, and click a node or a link in it."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Page, expect

from server.scene.colours import DARK
from tests.web.conftest import OpenPage
from tests.web.served import Served

#: Rendering without a graphics card takes its time.
SLOW = 60_000
_BAR_PX = 48
#: The graph alone has fewer colours, whether drawing is slow (8,000) or not (2,500); the first of the cloud have more.
_FEW = 10_000


@pytest.fixture(scope="module")
def viewed(finished_map: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server of a copy, whose 3D view these tests may change."""
    folder = tmp_path_factory.mktemp("viewed")
    shutil.copy(finished_map, folder / "flat.db")
    server = Served("serve", str(folder), "--port", "0")
    yield server
    server.close()


def seen(page: Page) -> NDArray[np.uint8]:
    """What the 3D view shows, BGR; black where the page's own bars lie over it."""
    data = np.frombuffer(page.locator("iframe.scene-frame").screenshot(timeout=SLOW), dtype=np.uint8)
    image = np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR), dtype=np.uint8).copy()
    image[:_BAR_PX] = image[-_BAR_PX:] = 0
    return image


def near(image: NDArray[np.uint8], rgb: tuple[int, int, int], tolerance: int = 40) -> NDArray[np.bool_]:
    """Pixels of about this colour; lit surfaces are a little darker or lighter."""
    return np.asarray(np.abs(image.astype(int) - np.array(rgb[::-1])).max(axis=2) <= tolerance)


def colours(image: NDArray[np.uint8]) -> int:
    return len(np.unique(image.reshape(-1, 3), axis=0))


def wait_until(page: Page, holds: Callable[[NDArray[np.uint8]], bool], what: str) -> NDArray[np.uint8]:
    """Waits for a picture that fits; the picture."""
    for _ in range(30):
        image = seen(page)
        if holds(image):
            return image
        page.wait_for_timeout(1000)
    raise AssertionError(f"not seen in the 3D view: {what}")


def wait_for_picture(page: Page, colour: tuple[int, int, int]) -> NDArray[np.uint8]:
    return wait_until(page, lambda now: near(now, colour).sum() > 30, f"the colour {colour}")


def test_the_graph_is_there_and_layers_switch(viewed: Served, open_page: OpenPage) -> None:
    page = open_page(viewed, "#/map/flat/loops", in_3d=True)
    image = wait_for_picture(page, DARK.wm)
    assert near(image, DARK.loop).sum() > 30, "loop links stand out"
    legend = page.get_by_role("list", name="Legend")
    expect(legend).to_contain_text(re.compile(r"WM \d+"))
    cloud = page.get_by_role("button", name="Cloud", exact=True)
    assert cloud.get_attribute("aria-pressed") == "true"
    wait_until(page, lambda now: colours(now) > _FEW, "the cloud has the colours of the room")
    cloud.click()
    expect(cloud).to_have_attribute("aria-pressed", "false")
    without = graph_alone(page, DARK.wm)
    grid = page.get_by_role("button", name="Grid", exact=True)
    grid.click()
    expect(grid).to_have_attribute("aria-pressed", "true")
    wait_until(page, lambda now: (now != without).any(axis=2).mean() > 0.02, "the grid covers floor")


def graph_alone(page: Page, rgb: tuple[int, int, int]) -> NDArray[np.uint8]:
    """A picture with this colour, and without the last of a cloud, which may have it as well."""
    return wait_until(
        page, lambda now: near(now, rgb).sum() > 30 and colours(now) < _FEW, f"the colour {rgb} in the graph alone"
    )


def click_colour(page: Page, rgb: tuple[int, int, int], reached: re.Pattern[str]) -> None:
    """Clicks pixels of a colour until the page goes where it should; looks anew in between, as the view may move."""
    box = page.locator("iframe.scene-frame").bounding_box()
    assert box
    for first in range(0, 20, 4):
        # Where the colour is thickest one hits what has it.
        thick = cv2.boxFilter(near(graph_alone(page, rgb), rgb).astype(np.float32), -1, (5, 5))
        order = np.argsort(thick, axis=None)[::-1][:: max(1, int((thick > 0).sum() // 200))]
        for y, x in zip(*np.unravel_index(order[first : first + 4], thick.shape), strict=True):
            page.mouse.click(box["x"] + float(x), box["y"] + float(y))
            page.wait_for_timeout(1500)
            if reached.search(page.url):
                return
    raise AssertionError(f"no click reached {reached.pattern}")


def without_cloud(page: Page) -> None:
    cloud = page.get_by_role("button", name="Cloud", exact=True)
    expect(cloud).to_be_enabled(timeout=SLOW)
    if cloud.get_attribute("aria-pressed") == "true":
        cloud.click()
    expect(cloud).to_have_attribute("aria-pressed", "false")


def test_a_click_on_a_node_opens_it(viewed: Served, open_page: OpenPage) -> None:
    page = open_page(viewed, "#/map/flat/stats", in_3d=True)
    without_cloud(page)
    click_colour(page, DARK.wm, re.compile(r"/nodes/\d+"))
    expect(page.get_by_role("region", name=re.compile(r"Node \d+"))).to_be_visible()


def test_a_click_on_a_loop_link_opens_its_evidence(viewed: Served, open_page: OpenPage) -> None:
    page = open_page(viewed, "#/map/flat/stats", in_3d=True)
    without_cloud(page)
    click_colour(page, DARK.loop, re.compile(r"/loops/\d+-\d+"))
    expect(page.get_by_role("region", name=re.compile(r"Link \d+ to \d+"))).to_be_visible()


def test_what_is_chosen_in_a_table_is_marked_in_3d(viewed: Served, open_page: OpenPage) -> None:
    page = open_page(viewed, "#/map/flat/nodes", in_3d=True)
    without_cloud(page)
    before = graph_alone(page, DARK.wm)
    page.get_by_role("row").nth(4).click()
    # What an earlier test selected may have been marked, and larger than a node.
    marked = near(before, DARK.selected)
    wait_until(page, lambda now: (near(now, DARK.selected) & ~marked).sum() > 10, "a mark")
    # Its mesh comes with the colours of the room, and the picture that is saved has them as well.
    page.get_by_role("group", name="The node in the 3D view").get_by_role("button", name="Mesh").click()
    meshed = wait_until(page, lambda now: colours(now) > 3 * colours(before), "the mesh of the node")
    page.get_by_role("button", name=re.compile("Save from this map")).click()
    with page.expect_download(timeout=SLOW) as saved:
        page.get_by_role("region", name="3D view", exact=True).get_by_role("button", name="Save").click()
    picture = np.asarray(cv2.imread(str(saved.value.path())), np.uint8)
    # Where drawing is slow the view has fewer pixels than its place on the page.
    (height, width), (rows, columns) = picture.shape[:2], meshed.shape[:2]
    assert width / height == pytest.approx(columns / rows, rel=0.02) and width > 200
    mesh = np.abs(meshed.astype(int) - before).max(axis=2) > 40
    saved_there, seen_there, before_there = (
        image[mesh].astype(float) for image in (cv2.resize(picture, (columns, rows)), meshed, before)
    )
    assert np.abs(saved_there - seen_there).mean() < 0.5 * np.abs(saved_there - before_there).mean(), "what was seen"
