"""A link by hand, more loops as a job, and nodes, on the page."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import expect

from tests.web.conftest import OpenPage
from tests.web.served import Served

LOOPS = "#/map/flat/loops"
#: The first decision starts a process.
SLOW = 90_000


@pytest.fixture(scope="module")
def own(finished_map: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server of a copy that these tests may change."""
    folder = tmp_path_factory.mktemp("links")
    shutil.copy(finished_map, folder / "flat.db")
    server = Served("serve", str(folder), "--port", "0")
    yield server
    server.close()


def test_a_rejected_loop_is_linked_again_by_hand_detected_in_bulk_and_undone(own: Served, open_page: OpenPage) -> None:
    page = open_page(own, LOOPS)
    page.get_by_role("row").filter(has_text="accepted").first.click()
    expect(page).to_have_url(re.compile(r"/loops/\d+-\d+"))
    from_id, to_id = page.url.rsplit("/", 1)[1].split("-")
    expect(page.locator("#reject")).to_be_enabled()
    page.keyboard.press("r")
    expect(page.locator("#effect")).to_contain_text("Rejected", timeout=SLOW)

    page.get_by_role("navigation", name="Loops").get_by_role("link", name="Link").click()
    tool = page.locator(".link-tool")
    expect(tool).to_contain_text(f"Nodes {from_id} and {to_id} are not linked")
    expect(page.locator("#link-accept")).to_be_disabled()
    page.locator("#link-preview").click()
    outcome = page.locator("#link-outcome")
    expect(outcome).to_contain_text(re.compile(r"Inliers\s*\d+ of \d+"), timeout=SLOW)
    expect(outcome).to_contain_text(re.compile(r"would do this.*χ² [\d.,]+ → [\d.,]+", re.S))
    page.locator("#link-accept").click()
    expect(tool).to_contain_text("joined by a link of type UserClosure", timeout=SLOW)

    # A false transform is objected to.
    tool.get_by_role("button", name="Type").click()
    tool.get_by_label("x (m)").first.fill("3")
    page.locator("#link-preview").click()
    expect(outcome).to_contain_text("RGBD/OptimizeMaxError", timeout=SLOW)
    expect(page.locator("#link-accept")).to_be_disabled()

    page.get_by_role("link", name="Bulk").click()
    page.locator("#job-start").click()
    job = page.locator("#job")
    expect(job).to_contain_text("Done", timeout=SLOW)
    expect(job).to_contain_text(re.compile(r"\d+ loops found, \d+ pairs tried"))
    page.get_by_role("link", name="Journal").click()
    expect(page.get_by_role("listitem").filter(has_text="Added").first).to_be_visible()


def test_a_node_is_labelled_and_leaves_the_map(own: Served, open_page: OpenPage) -> None:
    page = open_page(own, "#/map/flat/nodes/7")
    page.get_by_label("Label of the node").fill("door")
    page.locator("#node-label").click()
    expect(page.locator(".inspector-head")).to_contain_text("door", timeout=SLOW)
    page.locator("#node-drop").click()
    expect(page.get_by_text("Node 7 would leave the map")).to_be_visible(timeout=SLOW)
    page.locator("#node-drop-do").click()
    expect(page.get_by_text("none: merged or dropped")).to_be_visible(timeout=SLOW)
    page.goto(f"{own.base}{LOOPS}?tab=journal")
    first = page.locator(".journal > li").first
    expect(first).to_contain_text("Removed")
    page.locator("#journal-undo").click()
    expect(page.locator(".undone").first).to_contain_text("Removed", timeout=SLOW)
