"""Pick a node in the table and see its images, key points and statistics."""

from __future__ import annotations

import re

from playwright.sync_api import Page, expect

from tests.web.conftest import OpenPage, until
from tests.web.served import Served

NODES = "#/map/flat/nodes"
#: Whether the 3D view of this window marks these.
MARKED = """async (wanted) => {
    const scene = await (await fetch(`api/scene/flat?viewer=${sessionStorage["slamdeck.viewer"]}`)).json();
    return Object.entries(wanted).every(([name, value]) => JSON.stringify(scene[name]) === JSON.stringify(value));
}"""


def paints(page: Page, label: str, colours: int) -> None:
    """Waits until a canvas shows more than so many colours."""
    canvas = page.get_by_role("img", name=label).element_handle()
    until(
        page,
        """([canvas, colours]) => new Set(new Uint32Array(
            canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size > colours""",
        [canvas, colours],
    )


def test_a_row_opens_the_node_with_images_and_figures(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, NODES)
    page.get_by_role("row").filter(has_text=re.compile(r"^10")).click()
    expect(page).to_have_url(re.compile(r"#/map/flat/nodes/10$"))
    inspector = page.get_by_role("region", name="Node 10")
    expect(inspector.get_by_text(re.compile(r"\d+ words"))).to_be_visible()
    paints(page, "Colour image of node 10", 500)
    paints(page, "Depth image of node 10", 20)
    line = inspector.locator(".pixel-line")
    expect(line).to_contain_text("Point at a pixel")
    inspector.get_by_role("img", name="Depth image of node 10").hover()
    expect(line).to_contain_text(re.compile(r"pixel\s*1[56]\d.*\d\.\d{3} m.*base.*map", re.S))
    expect(inspector.locator(".cross")).to_have_count(2)
    expect(inspector.get_by_role("row", name="Odometry")).to_contain_text("m")
    expect(inspector.get_by_role("link", name="node 9")).to_be_visible()
    inspector.get_by_text("Statistics of its update").click()
    inspector.get_by_role("searchbox", name="Find a statistic").fill("Odometry/Inliers")
    expect(inspector.get_by_role("row", name="Odometry/Inliers/")).to_contain_text(re.compile(r"\d"))


def test_key_points_can_be_switched_off(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, f"{NODES}/7")
    toggle = page.get_by_role("button", name="Key points")
    expect(page.get_by_text(re.compile(r"\d+ words"))).to_be_visible()
    shot = page.get_by_role("img", name="Colour image of node 7")
    with_points = shot.screenshot()
    toggle.click()
    expect(toggle).to_have_attribute("aria-pressed", "false")
    page.wait_for_timeout(300)
    assert shot.screenshot() != with_points


def test_images_open_as_large_as_the_window(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, f"{NODES}/7")
    page.get_by_role("button", name="Colour image of node 7").click()
    dialog = page.get_by_role("dialog", name="Node 7, colour")
    box = dialog.bounding_box()
    assert box is not None
    assert box["width"] > 1000
    page.keyboard.press("Escape")
    expect(dialog).to_be_hidden()


def test_the_table_sorts_searches_and_follows_the_keys(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, NODES)
    rows = page.get_by_role("table", name="Nodes").get_by_role("row")
    page.get_by_role("button", name="Node", exact=True).click()
    expect(page.get_by_role("columnheader", name="Node")).to_have_attribute("aria-sort", "descending")
    page.get_by_role("button", name="Node", exact=True).click()
    expect(rows.nth(1)).to_contain_text(re.compile(r"^1"))
    page.get_by_role("rowgroup").focus()
    page.keyboard.press("End")
    expect(page).to_have_url(re.compile(r"/nodes/\d\d+$"))
    page.keyboard.press("k")
    last = int(page.url.rsplit("/", 1)[1])
    expect(page.get_by_role("row", selected=True)).to_contain_text(str(last))
    here = int(page.evaluate("location.hash.split('/').pop()"))
    for node in (here - 1, here - 2, here - 3):
        page.keyboard.press("k")
        expect(page).to_have_url(re.compile(rf"/nodes/{node}$"))
        expect(page.get_by_role("row", selected=True)).to_contain_text(re.compile(rf"^{node}"))
    page.get_by_role("searchbox", name="Find nodes by id, label, time or place").fill("12")
    expect(rows.nth(1)).to_contain_text("12")
    page.get_by_role("searchbox").fill("id:5..6 loops:>=0")
    expect(page.get_by_role("table", name="Nodes")).to_have_attribute("aria-rowcount", "3")
    page.get_by_role("searchbox").fill("near here")
    expect(page.get_by_text("near needs a place")).to_be_visible()


def test_two_nodes_stand_side_by_side_with_their_words(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, f"{NODES}/7")
    page.locator("#compare").click()
    expect(page).to_have_url(re.compile(r"/nodes/7\?b=\d+$"))
    page.get_by_role("spinbutton", name="Id of node B").fill("9")
    page.keyboard.press("Enter")
    page.keyboard.press("Tab")
    pair = page.get_by_role("region", name="Nodes 7 and 9")
    expect(pair.get_by_text(re.compile(r"[1-9]\d* words? in both, of \d+ and \d+"))).to_be_visible()
    expect(pair.get_by_role("row", name="Odometry")).to_contain_text(re.compile(r"\d+\.\d c?m.*\d+\.\d °", re.S))
    expect(pair.get_by_role("link", name="Link them…")).to_be_visible()
    paints(page, "Images of node 7 (left) and node 9 (right) with the words that both have", 500)
    # J and K step the first, with Shift the second; clicks go to the second.
    page.get_by_role("heading", name="B as seen from A").click()
    page.keyboard.press("k")
    expect(page).to_have_url(re.compile(r"/nodes/6\?b=9$"))
    page.keyboard.press("Shift+J")
    expect(page).to_have_url(re.compile(r"/nodes/6\?b=10$"))
    page.keyboard.press("x")
    expect(page).to_have_url(re.compile(r"/nodes/10\?b=6$"))
    page.get_by_role("row").filter(has_text=re.compile(r"^9")).click()
    expect(page).to_have_url(re.compile(r"/nodes/10\?b=9$"))
    expect(
        pair.or_(page.get_by_role("region", name="Nodes 10 and 9")).get_by_role("link", name="evidence")
    ).to_be_visible()
    until(page, MARKED, {"selected_node": None, "selected_link": [10, 9]})
    page.goto(f"{library.base}#/map/flat/stats")
    until(page, MARKED, {"selected_node": 10, "selected_link": None})
    page.go_back()
    page.get_by_role("button", name="Look at the first alone").click()
    expect(page.get_by_role("region", name="Node 10")).to_be_visible()


def test_a_node_that_is_not_there_says_which_are(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, f"{NODES}/99999")
    expect(page.get_by_role("alert")).to_contain_text("99999")


def test_a_map_that_is_whole_has_no_banner(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, NODES)
    expect(page.get_by_role("row").filter(has_text=re.compile(r"^7"))).to_be_visible()
    expect(page.locator(".banners")).to_be_empty()
