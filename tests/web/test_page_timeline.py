"""Go back through the updates of a map, by keys, by events and by a link."""

from __future__ import annotations

import re

from playwright.sync_api import Page, expect

from tests.web.conftest import OpenPage, until
from tests.web.served import Served

#: Whether the 3D view was told to show the moment of a node, null for now.
SCENE_AT = (
    "async (at) => (await (await fetch('api/scene/flat?viewer=' + sessionStorage['slamdeck.viewer'])).json()).at === at"
)


def shown(page: Page) -> int:
    """The node whose moment is shown."""
    found = re.search(r"node (\d+)", page.locator(".timeline-shown").inner_text())
    assert found
    return int(found[1])


def test_the_past_is_walked_through_and_its_link_reopens_it(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, "#/map/flat/nodes", in_3d=True)
    slider = page.get_by_role("slider", name="Update that is shown")
    expect(slider).to_be_enabled()
    page.keyboard.press("ArrowLeft")
    last = shown(page)
    page.keyboard.press("ArrowLeft")
    assert shown(page) < last
    page.keyboard.press("ArrowRight")
    assert shown(page) == last
    page.get_by_role("button", name="What happened").click()
    page.get_by_role("button", name=re.compile("Loop accepted")).click()
    page.get_by_role("table", name="Events").get_by_role("row").nth(1).click()
    at = shown(page)
    expect(page).to_have_url(re.compile(rf"/nodes\?at={at}$"))
    until(page, SCENE_AT, at)
    expect(page.locator(".timeline-shown")).to_contain_text("poses of then")
    page.keyboard.press("Escape")
    page.get_by_role("link", name="Stats").click()
    expect(page).to_have_url(re.compile(rf"/stats\?at={at}$"))
    page.goto(library.base + "#/map/flat/maps")
    expect(page.locator(".timeline-shown")).to_contain_text("now")
    page.goto(f"{library.base}#/map/flat/loops?at={at}")
    page.reload()
    expect(page.locator(".timeline-shown")).to_contain_text(f"node {at}")
    page.keyboard.press("n")
    expect(page).to_have_url(re.compile("/loops$"))
    until(page, SCENE_AT, None)


def test_it_plays_to_now(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, "#/map/flat/nodes")
    page.get_by_label("Speed").select_option("16")
    expect(page.get_by_role("slider", name="Update that is shown")).to_be_enabled()
    page.keyboard.press("p")
    expect(page.locator(".timeline-shown")).to_contain_text("node")
    expect(page.get_by_role("button", name="Pause (P)")).to_be_visible()
    expect(page.locator(".timeline-shown")).to_contain_text("now")
    expect(page.get_by_role("button", name="Play (P)")).to_be_visible()


def test_the_graph_is_optimised_on_trial_and_its_links_hide(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, "#/map/flat/graph")
    page.get_by_label("Count Global loop links").uncheck()
    page.get_by_role("button", name="Optimise", exact=True).click()
    expect(page.get_by_role("table", name="Before and after")).to_contain_text("χ²")
    scene = "async () => (await (await fetch('api/scene/flat?viewer=' + sessionStorage['slamdeck.viewer'])).json())"
    until(page, f"async () => (await ({scene})()).optimised?.ask.without[0] === 'GlobalClosure'")
    page.get_by_role("button", name="Keep these poses…").click()
    dialog = page.get_by_role("dialog", name="Keep these poses")
    expect(dialog).to_contain_text("moved")
    expect(dialog).to_contain_text("A later decision")
    dialog.get_by_role("button", name="Cancel").click()
    page.get_by_label("Show Global loop links").uncheck()
    until(page, f"async () => (await ({scene})()).hidden_links[0] === 'loop'")
    page.get_by_label("Show Global loop links").check()
    page.get_by_role("button", name="Clear").click()
    until(
        page,
        f"async () => {{ const now = await ({scene})(); return now.optimised === null && !now.hidden_links.length }}",
    )
    expect(page.get_by_role("region", name="Components")).to_contain_text("hang together")
