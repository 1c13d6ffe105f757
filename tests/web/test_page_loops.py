"""Click a link and see both images with their matches; approve or reject it, see the effect, undo it."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.web.conftest import OpenPage
from tests.web.served import Served

LOOPS = "#/map/flat/loops"
#: The first decision starts a process.
SLOW = 90_000


@pytest.fixture(scope="module")
def own(finished_map: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server of a copy that these tests may change."""
    folder = tmp_path_factory.mktemp("own")
    shutil.copy(finished_map, folder / "flat.db")
    server = Served("serve", str(folder), "--port", "0")
    yield server
    server.close()


def first_accepted(page: Page) -> str:
    """Opens the first accepted loop; its key."""
    page.get_by_role("row").filter(has_text="accepted").first.click()
    expect(page).to_have_url(re.compile(r"/loops/\d+-\d+"))
    return page.url.rsplit("/", 1)[1]


def test_a_loop_shows_its_evidence(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, LOOPS)
    from_id, to_id = first_accepted(page).split("-")
    evidence = page.get_by_role("region", name=f"Link {from_id} to {to_id}")
    expect(evidence.get_by_role("button", name=re.compile(r"^Inliers \d+"))).to_be_visible()
    picture = evidence.get_by_role("img", name=f"Images of node {from_id} (left) and node {to_id} (right)")
    greens = picture.evaluate(
        """canvas => { const d = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
            let n = 0; for (let i = 0; i < d.length; i += 4) n += d[i + 1] > d[i] + 60 && d[i + 1] > d[i + 2] + 40;
            return n; }"""
    )
    assert greens > 100, "inlier lines are drawn"
    for name in ("Inliers", "Sigma", "Residual", "Moved"):
        expect(evidence.get_by_text(name, exact=True)).to_be_visible()
    for name in ("Measured", "Optimised", "Apart"):
        expect(evidence.get_by_role("row", name=name)).to_contain_text(re.compile(r"\d m.*\d °", re.S))
    expect(evidence.locator("#why")).to_contain_text("Vis/MinInliers")
    evidence.get_by_text("Covariance 6×6").click()
    covariance = evidence.locator(".covariance")
    expect(covariance.get_by_role("rowheader")).to_have_text(["x", "y", "z", "roll", "pitch", "yaw"])
    clouds = evidence.get_by_role("group", name="Clouds in the 3D view")
    clouds.get_by_role("button", name="by the link").click()
    expect(clouds.get_by_role("button", name="by the link")).to_have_attribute("aria-pressed", "true")
    clouds.get_by_role("button", name="by the link").click()
    page.get_by_label("Type").select_option("GlobalClosure")
    first_accepted(page)
    expect(page.locator("#belief")).to_contain_text(re.compile(r"all places.*LoopThr", re.S))


def test_keys_walk_through_the_queue(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, LOOPS)
    expect(page.get_by_role("row").nth(1)).to_be_visible()
    page.keyboard.press("j")
    expect(page).to_have_url(re.compile(r"/loops/\d+-\d+"))
    first = page.url
    page.keyboard.press("j")
    expect(page).not_to_have_url(first)
    page.keyboard.press("k")
    expect(page).to_have_url(first)
    # From a loop to odometry's link at its node: the queue does not list it, and it is walked along the path.
    page.get_by_role("navigation", name="Links along the path").get_by_role("link", name="The odometry link").click()
    walk = page.get_by_role("navigation", name="Links along the path")
    expect(walk).to_contain_text(re.compile(r"Odometry link \d+ of \d+ along the path"))
    from_id, to_id = (int(i) for i in page.url.rsplit("/", 1)[1].split("-"))
    page.keyboard.press("k")
    expect(page).to_have_url(re.compile(rf"/loops/{from_id - 1}-{to_id - 1}$"))


def test_filters_and_order(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, LOOPS)
    rows = page.get_by_role("table", name="Loop closures").get_by_role("row")
    expect(rows.nth(1)).to_be_visible()
    page.get_by_label("Type").select_option("GlobalClosure")
    expect(rows.filter(has_text="proximity")).to_have_count(0)
    page.get_by_label("Least inliers").select_option("80")
    expect(page).to_have_url(re.compile(r"type=GlobalClosure&inliers=80$"))
    page.get_by_role("button", name="Inliers", exact=True).click()
    shown = [int(text.split("/")[0]) for text in page.locator(".table-row .cell:nth-child(5)").all_inner_texts()]
    assert shown == sorted(shown, reverse=True)
    assert min(shown) >= 80
    page.get_by_role("button", name="More").click()
    page.get_by_label("Inlier ratio, at most").fill("0.9")
    page.get_by_label("Sort by").select_option("ratio")
    expect(page.get_by_role("columnheader", name="Ratio")).to_be_visible()
    ratios = [float(text) for text in page.locator(".table-row .cell:last-child").all_inner_texts()]
    assert ratios == sorted(ratios, reverse=True)
    assert max(ratios) <= 0.9
    page.get_by_role("button", name="Weigh by GNC").click()
    expect(page.get_by_role("columnheader", name="GNC")).to_be_visible(timeout=SLOW)
    page.get_by_role("columnheader", name="GNC").get_by_role("button").click()
    expect(page.locator(".table-row .cell:last-child").first).to_have_text(re.compile(r"\d\.\d\d"))


def test_another_threshold_says_which_loops_would_come_and_go(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, f"{LOOPS}?tab=what-if")
    outcomes = page.get_by_role("group", name="Outcome")
    expect(outcomes.get_by_role("button", name="goes 0")).to_be_visible()
    page.get_by_label("Threshold").fill("1")
    page.keyboard.press("Enter")
    expect(outcomes.get_by_role("button", name=re.compile("goes [1-9]"))).to_be_visible()
    rows = page.get_by_role("table", name="Foreseen loops").get_by_role("row")
    expect(rows.filter(has_text="goes").first).to_contain_text("yes")
    expect(page.locator(".what-if-facts")).to_contain_text(re.compile(r"Recall\s*0.0 %.*ATE.* → ", re.S))
    expect(page.get_by_role("list", name="Legend")).to_contain_text("at LoopThr 1")
    expect(page.locator("#what-if-apply")).to_be_enabled()
    page.locator("#reject-all").click()
    expect(page.locator("#bulk-changes")).to_contain_text(re.compile(r"\d+ loops? lost"), timeout=SLOW)
    page.get_by_role("button", name="Cancel").click()
    # The line in the chart of the hypothesis is another handle of the same threshold.
    box = page.locator(".strip-chart .u-over").nth(2).bounding_box()
    assert box is not None
    top = box["y"] + box["height"] * (1 - 1 / 1.08)
    page.mouse.move(box["x"] + 20, top)
    page.mouse.down()
    page.mouse.move(box["x"] + 20, box["y"] + box["height"] / 2, steps=4)
    page.mouse.up()
    expect(page.get_by_label("Threshold")).to_have_value(re.compile(r"0\.[3-7]"))
    page.get_by_role("link", name="Queue").click()
    expect(page.get_by_role("list", name="Legend")).not_to_contain_text("at LoopThr")


def test_reject_shows_the_effect_and_undo_takes_it_back(own: Served, open_page: OpenPage) -> None:
    page = open_page(own, LOOPS)
    key = first_accepted(page)
    name = " → ".join(key.split("-"))
    row = page.get_by_role("row", selected=True)
    # The address changes before the view does.
    expect(page.locator("#reject")).to_be_enabled()
    page.keyboard.press("r")
    effect = page.locator("#effect")
    expect(effect).to_contain_text(f"Rejected {name}", timeout=SLOW)
    expect(effect).to_contain_text(re.compile(r"χ² [\d.,]+ → [\d.,]+"))
    expect(effect).to_contain_text(re.compile(r"moved \d+ poses?"))
    expect(effect).to_contain_text("ATE")
    expect(row).to_contain_text("rejected")
    page.keyboard.press("r")
    expect(page.get_by_text(f"{name}: it is rejected already")).to_be_visible()
    page.keyboard.press("u")
    expect(effect).to_contain_text(f"Undid {name}", timeout=SLOW)
    expect(row).to_contain_text("accepted")
    page.get_by_role("link", name="Journal").click()
    entries = page.get_by_role("listitem").filter(has_text=name)
    expect(entries.first).to_be_visible()
    expect(page.locator(".undone")).to_contain_text("Rejected")


def test_all_that_is_shown_is_foreseen_rejected_and_taken_back_at_once(own: Served, open_page: OpenPage) -> None:
    page, other = open_page(own, LOOPS), open_page(own, f"{LOOPS}?tab=journal")
    other.get_by_label("Decided by").fill("ben")
    entries = other.get_by_role("listitem").filter(has_text=re.compile(r"Rejected \d+ loops"))
    page.get_by_label("Least inliers").select_option("80")
    page.get_by_role("button", name=re.compile(r"^Reject \d+")).click()
    dialog = page.get_by_role("dialog", name="Reject loops")
    effect = page.locator("#bulk-effect")
    expect(effect).to_contain_text(
        re.compile(r"would do this.*χ² [\d.,]+ → [\d.,]+.*moved \d+ pose.*ATE", re.S), timeout=SLOW
    )
    expect(entries).to_have_count(0)
    dialog.get_by_label("Decided by").fill("ann")
    dialog.get_by_role("button", name=re.compile(r"^Reject \d+")).click()
    expect(dialog).to_contain_text(re.compile(r"\d+ loops rejected"), timeout=SLOW)
    expect(entries).to_contain_text("ann")
    # Whoever looks at the map from elsewhere sees it at once, and may take it back.
    other.get_by_role("button", name="Undo").click()
    expect(other.locator(".undone").first).to_contain_text(re.compile(r"Rejected \d+ loops"), timeout=SLOW)
    expect(page.locator(".table-row").filter(has_text="rejected")).to_have_count(0)


def test_approve_by_button_is_journalled(own: Served, open_page: OpenPage) -> None:
    page = open_page(own, LOOPS)
    key = first_accepted(page)
    page.locator("#approve").click()
    expect(page.locator("#effect")).to_contain_text("Approved", timeout=SLOW)
    expect(page.get_by_role("row", selected=True)).to_contain_text("approved")
    reopened = open_page(own, f"{LOOPS}/{key}")
    expect(reopened.get_by_role("row", selected=True)).to_contain_text("approved")
    reopened.keyboard.press("u")
    expect(reopened.get_by_role("row", selected=True)).to_contain_text("accepted", timeout=SLOW)
