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
    # Numbers begin where the map has both nodes.
    tool.get_by_role("button", name="Type").click()
    expect(tool.get_by_label("x (m)").first).not_to_have_value("0")
    # Points are picked as large as the window, and stay when that closes.
    tool.get_by_role("button", name="Points").click()
    tool.get_by_role("button", name="Pick in large images").click()
    for node_id in (from_id, to_id):
        page.get_by_role("dialog").get_by_role("img", name=f"Pick points of node {node_id}").click()
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_have_count(0)
    expect(tool.locator("#points-asked")).to_contain_text("1 pair")
    # The second point of the next pair is picked in a cloud, turned before.
    page.get_by_role("img", name=f"Pick points of node {from_id}", exact=True).click()
    tool.get_by_role("button", name="Clouds").click()
    cloud = page.get_by_role("img", name=f"Pick points of the cloud of node {to_id}", exact=True)
    cloud.press("ArrowLeft")
    cloud.press("Enter")
    expect(tool.locator("#points-asked")).to_contain_text(f"in the cloud of node {from_id}; 2 pairs")
    tool.get_by_role("button", name="Match").click()
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
    expect(job).to_contain_text("Detecting loops: done", timeout=SLOW)
    expect(job).to_contain_text(re.compile(r"\d+ loops found, \d+ pairs tried"))
    # Other work has an address of its own, and the batch is taken back here only as long as nothing was decided since.
    page.get_by_role("button", name="Refine links").click()
    expect(page).to_have_url(re.compile(r"tab=jobs&work=refine$"))
    page.get_by_label("to node").fill("4")
    page.locator("#job-start").click()
    expect(job).to_contain_text("Refining links: done", timeout=SLOW)
    expect(page.locator("#job-undo")).to_be_enabled()
    page.get_by_role("link", name="Journal").click()
    expect(page.get_by_role("listitem").filter(has_text="Added").first).to_be_visible()


def test_a_node_is_labelled_and_leaves_the_map(own: Served, open_page: OpenPage) -> None:
    page = open_page(own, "#/map/flat/nodes/7")
    page.locator("#node-regrid").click()
    expect(page.locator("#regrid-preview")).to_contain_text("node 7 as it is")
    page.get_by_label("RangeMax (m)").fill("1.5")
    preview = page.locator("#regrid-preview figcaption")
    expect(preview.last).not_to_have_text(preview.first.inner_text().replace("node 7 as it is", "made anew"))
    page.locator("#job-start").click()
    expect(page.locator("#job")).to_contain_text("Local grids of node 7: Grid/RangeMax 1.5", timeout=SLOW)
    page.locator("#job-undo").click()
    expect(page.locator("#job")).to_contain_text("taken back", timeout=SLOW)

    page.goto(f"{own.base}#/map/flat/nodes/7")
    page.get_by_label("Label of the node").fill("door")
    page.locator("#node-label").click()
    expect(page.locator(".inspector-head")).to_contain_text("door", timeout=SLOW)
    page.locator("#node-drop").click()
    expect(page.locator("#bulk-changes")).to_contain_text("1 node leaving", timeout=SLOW)
    page.locator("#bulk-do").click()
    expect(page.get_by_role("dialog")).to_contain_text("Node 7 left the map", timeout=SLOW)
    page.get_by_role("button", name="Close").click()
    expect(page.get_by_text("none: merged or dropped")).to_be_visible(timeout=SLOW)
    page.goto(f"{own.base}{LOOPS}?tab=journal")
    first = page.locator(".journal > li").first
    expect(first).to_contain_text("Removed")
    page.locator("#journal-undo").click()
    expect(page.locator(".undone").first).to_contain_text("Removed", timeout=SLOW)


def test_several_nodes_are_chosen_and_foreseen_and_a_prior_is_let_count(own: Served, open_page: OpenPage) -> None:
    page = open_page(own, "#/map/flat/nodes")
    row = page.get_by_role("table", name="Nodes").get_by_role("row")
    row.nth(2).click()
    row.nth(4).click(modifiers=["Shift"])
    chosen = page.locator("#choice")
    expect(chosen).to_contain_text("3 nodes chosen")
    row.nth(3).click(modifiers=["Control"])
    expect(chosen).to_contain_text("2 nodes chosen")
    chosen.get_by_label("Stretch").fill("5")
    chosen.get_by_label("to", exact=True).fill("9")
    page.locator("#choose-stretch").click()
    expect(chosen).to_contain_text("5 nodes chosen")
    page.locator("#drop-chosen").click()
    expect(page.locator("#bulk-changes")).to_contain_text(re.compile("5 nodes leaving.*1 bridge"), timeout=SLOW)
    expect(page.locator("#bulk-effect")).to_contain_text(re.compile(r"χ² [\d.,]+ → [\d.,]+.*moved \d+ pose.*ATE", re.S))
    page.get_by_role("button", name="Cancel").click()

    page.locator("#prior summary").click()
    expect(page.locator("#priors-ignored")).to_be_visible()
    page.get_by_label("Let priors count").check()
    page.locator("#prior").get_by_label("z (m)").first.fill("2")
    page.locator("#prior-set").click()
    expect(page.locator("#bulk-changes")).to_contain_text("1 prior added", timeout=SLOW)
    expect(page.locator(".bulk-body")).to_contain_text("Optimizer/PriorsIgnored goes from true to false")
    page.locator("#bulk-do").click()
    expect(page.locator("#priors-ignored")).to_have_count(0, timeout=SLOW)
    page.locator("#bulk-undo").click()
    expect(page.locator("#priors-ignored")).to_be_visible(timeout=SLOW)
    expect(page.locator("#prior-remove")).to_have_count(0, timeout=SLOW)
