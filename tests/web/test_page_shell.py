"""The frame of the page: maps, links that reopen views, palette, theme, sizes."""

from __future__ import annotations

import re
from pathlib import Path

import cv2
import numpy as np
import pytest
from playwright.sync_api import expect

from tests.web.conftest import OpenPage, until
from tests.web.served import Served

#: tokens.css has it as --canvas of the dark theme.
_CANVAS = "rgb(15, 18, 23)"


def test_the_list_opens_a_map_and_names_what_is_wrong_with_a_broken_one(library: Served, open_page: OpenPage) -> None:
    page = open_page(library)
    broken = page.get_by_role("listitem").filter(has_text="broken")
    expect(broken).to_contain_text(re.compile("SQLite|database", re.I))
    card = page.get_by_role("link", name=re.compile("flat"))
    expect(card).to_contain_text(re.compile(r"\d+ nodes"))
    expect(card.locator("img")).to_be_visible()
    card.click()
    expect(page).to_have_url(re.compile(r"#/map/flat/loops$"))
    expect(page.locator(".switcher")).to_contain_text("flat")
    page.goto(f"{library.base}#/map/nothing/params")
    expect(page.get_by_role("alert").filter(has_text="The parameters didn't arrive")).to_contain_text("'nothing'")


@pytest.mark.parametrize(
    ("place", "heading"),
    [
        ("nodes/3", "Node 3"),
        ("loops", "Loop closures"),
        ("params?q=Vis", "Parameters"),
        ("stats", "Statistics"),
        ("maps", "Maps"),
    ],
)
def test_every_view_reopens_from_its_link(library: Served, open_page: OpenPage, place: str, heading: str) -> None:
    page = open_page(library, f"#/map/flat/{place}")
    expect(page.get_by_role("heading", name=heading, exact=True)).to_be_visible()


def test_the_3d_view_stays_while_views_change(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, "#/map/flat/loops", in_3d=True)
    expect(page.locator("iframe.scene-frame")).to_be_attached()
    page.wait_for_timeout(3000)
    view = next(frame for frame in page.frames if "/viser/" in frame.url)
    view.evaluate("() => { window.mark = 1; }")
    for key in "24513":
        page.keyboard.press(key)
        page.wait_for_timeout(200)
    assert view.evaluate("() => window.mark") == 1
    # It runs beside the page, not in its thread, and still hands over the page's own keys.
    assert view.evaluate("() => crossOriginIsolated")
    assert page.locator("iframe.scene-frame").evaluate("frame => frame.contentDocument") is None
    view.locator("body").press("Control+k")
    expect(page.get_by_role("combobox", name="Search or command")).to_be_visible()
    assert view.evaluate("() => getComputedStyle(document.body).backgroundColor") == _CANVAS


def test_the_first_canvas_does_not_wait_for_the_3d_view(library: Served, open_page: OpenPage) -> None:
    page = open_page(library)
    page.add_init_script("""{
      window.framesAtCanvas = [];
      const make = HTMLCanvasElement.prototype.getContext;
      HTMLCanvasElement.prototype.getContext = function (...what) {
        window.framesAtCanvas.push(document.querySelectorAll("iframe").length);
        return make.apply(this, what);
      };
    }""")
    page.goto(f"{library.base}#/map/flat/loops")
    page.reload()
    expect(page.locator("iframe")).to_be_attached()
    assert page.evaluate("framesAtCanvas[0]") == 0


def test_the_palette_goes_to_nodes_views_and_parameters(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, "#/map/flat/loops")
    page.keyboard.press("Control+k")
    page.get_by_role("combobox", name="Search or command").fill("12")
    page.keyboard.press("Enter")
    expect(page).to_have_url(re.compile(r"nodes/12$"))
    page.keyboard.press("Control+k")
    page.get_by_role("combobox", name="Search or command").fill("mininliers")
    page.keyboard.press("Enter")
    expect(page).to_have_url(re.compile(r"params\?q=Vis"))
    expect(page.get_by_label("Vis/MinInliers", exact=True)).to_be_visible()


def test_the_theme_follows_the_system_and_the_person(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, "#/map/flat/loops", "light")
    root = page.locator("html")
    expect(root).to_have_attribute("data-theme", "light")
    page.keyboard.press("t")
    expect(root).to_have_attribute("data-theme", "dark")
    page.reload()
    expect(root).to_have_attribute("data-theme", "dark")


def test_sizes_are_remembered(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, "#/map/flat/loops")
    panel = page.get_by_role("main")
    before = panel.bounding_box()
    page.get_by_role("separator", name="Width of the panel").focus()
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("ArrowLeft")
    after = panel.bounding_box()
    assert before and after
    assert after["width"] == before["width"] + 32
    page.reload()
    expect(page.get_by_role("row").nth(1)).to_be_visible()
    again = panel.bounding_box()
    assert again
    assert again["width"] == after["width"]


def test_statistics_can_be_added_and_lead_to_their_node(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, "#/map/flat/stats?names=Timing/Total/ms")
    picker = page.get_by_role("combobox", name="Find a statistic")
    picker.fill("inliers")
    page.get_by_role("checkbox", name="Odometry/Inliers/").check()
    page.keyboard.press("Escape")
    expect(page.locator(".stat-chart")).to_have_count(2)
    expect(page).to_have_url(re.compile("Odometry"))
    page.locator(".stat-chart .u-over").last.click(position={"x": 150, "y": 30})
    expect(page).to_have_url(re.compile(r"/nodes/\d+$"))


def test_statistics_are_saved_as_a_table_and_as_a_picture(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, "#/map/flat/stats?names=Timing/Total/ms,Odometry/Inliers/")
    expect(page.locator(".stat-chart output").first).not_to_have_text("—")
    with page.expect_download() as table:
        page.get_by_role("button", name="CSV").click()
    assert table.value.suggested_filename == "flat-statistics.csv"
    lines = Path(table.value.path()).read_text().splitlines()
    assert lines[0] == "node,stamp,Timing/Total/ms,Odometry/Inliers/"
    ids, stamps = (np.array([float(line.split(",")[column]) for line in lines[1:]]) for column in (0, 1))
    assert len(ids) > 20 and (np.diff(ids) > 0).all() and (np.diff(stamps) > 0).all()
    with page.expect_download() as picture:
        page.get_by_role("button", name="Save the chart of Timing/Total/ms as PNG").click()
    image = cv2.imread(str(picture.value.path()))
    assert image is not None and image.shape[1] > 300


def test_the_map_is_saved_for_other_tools(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, "#/map/flat/nodes/7")
    expect(page.get_by_role("img", name="Depth image of node 7")).to_be_visible()
    for kind in ("Colour", "Depth"):
        expect(page.get_by_role("img", name=f"{kind} image of node 7")).to_have_attribute("aria-busy", "false")
    with page.expect_download() as pictures:
        page.get_by_role("button", name="Save both pictures as PNG").click()
    assert pictures.value.suggested_filename == "flat-node-7.png"
    both = cv2.imread(str(pictures.value.path()))
    assert both is not None and both.shape[:2] == (240, 640)
    page.get_by_role("button", name=re.compile("Save from this map")).click()
    for part, name, start in (
        ("Poses", "flat.tum.txt", b"#"),
        ("Floor plan", "flat.grid.zip", b"PK"),
        ("Cloud", "flat.ply", b"ply"),
    ):
        with page.expect_download() as made:
            page.get_by_role("region", name=part).get_by_role("button", name="Save").click()
        assert made.value.suggested_filename == name
        assert Path(made.value.path()).read_bytes().startswith(start)


def test_a_chart_marks_the_node_under_the_pointer(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, "#/map/flat/stats?names=Timing/Total/ms")
    chart = page.locator(".stat-chart .u-over")
    chart.hover(position={"x": 150, "y": 30})
    viewer = "'api/scene/flat?viewer=' + sessionStorage['slamdeck.viewer']"
    marked = f"async () => (await (await fetch({viewer})).json()).selected_node"
    until(page, marked)
    page.get_by_role("heading", name="Statistics").hover()
    until(page, f"async () => (await ({marked})()) === null")


def test_hints_come_once_and_never_again(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, "#/map/flat/nodes", first=True)
    for number in (1, 2, 3):
        hint = page.get_by_role("dialog", name=f"Hint {number} of 3")
        expect(hint).to_be_in_viewport(ratio=1)
        hint.get_by_role("button", name="Done" if number == 3 else "Next").click()
    expect(page.get_by_role("dialog")).to_have_count(0)
    page.reload()
    expect(page.get_by_role("row").nth(1)).to_be_visible()
    expect(page.get_by_role("dialog")).to_have_count(0)
    page.keyboard.press("Control+k")
    page.get_by_role("combobox", name="Search or command").fill("hints")
    page.keyboard.press("Enter")
    expect(page.get_by_role("dialog", name="Hint 1 of 3")).to_be_visible()


def test_without_the_token_nobody_gets_in(library: Served, open_page: OpenPage) -> None:
    page = open_page(library)
    page.context.clear_cookies()
    response = page.goto(library.base)
    assert response is not None
    assert response.status in (401, 403)
