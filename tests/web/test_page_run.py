"""Watch a run: live charts, thresholds moved while it maps, pause, step, resume and stop."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.web.conftest import OpenPage, until
from tests.web.served import SMALL_TOUR, Served

LIVE = re.compile(r"#/map/live")
SLOW = 60_000


@pytest.fixture
def empty(tmp_path: Path) -> Iterator[Served]:
    """A server of a folder without maps."""
    server = Served("serve", str(tmp_path), "--port", "0")
    yield server
    server.close()


@pytest.fixture
def running(empty: Served, open_page: OpenPage) -> Page:
    """The page of a run that was started in it."""
    page = open_page(empty)
    expect(page.get_by_text("There are no maps yet")).to_be_visible()
    page.get_by_role("button", name="New run").click()
    page.get_by_role("textbox", name="Source").fill(SMALL_TOUR)
    page.get_by_role("textbox", name="Map").fill("live")
    page.get_by_role("checkbox", name="As fast as it was recorded").uncheck()
    page.get_by_role("button", name="Start", exact=True).click()
    expect(page).to_have_url(LIVE, timeout=SLOW)
    return page


def figure(page: Page, chart: str, pattern: str) -> float:
    """A number in the caption of a live chart."""
    text = page.locator(".strip-chart").filter(has_text=chart).locator("figcaption").inner_text()
    found = re.search(pattern, text)
    return float(found[1].replace(",", "")) if found else -1.0


def nodes(page: Page) -> int:
    found = re.search(r"node ([\d,]+)", page.get_by_role("banner").inner_text())
    return int(found[1].replace(",", "")) if found else 0


WM_AT_LEAST = "n => Number(/WM ([\\d,]+)/.exec(document.querySelector('.strip')?.innerText)?.[1] ?? 0) >= n"
LTM_AT_LEAST = "n => Number(/LTM ([\\d,]+)/.exec(document.querySelector('.strip')?.innerText)?.[1] ?? 0) >= n"


def set_parameter(page: Page, name: str, value: str) -> None:
    """Types a value and waits until the engine echoes it."""
    field = page.get_by_label(name, exact=True)
    field.fill(value)
    field.press("Enter")
    force = page.locator(f'[data-name="{name}"] output')
    expect(force).to_contain_text(re.compile(rf"in force {re.escape(value)}\b"), timeout=SLOW)


def test_charts_grow_while_it_maps(running: Page) -> None:
    until(running, WM_AT_LEAST, 5)
    assert figure(running, "Update time", r"([\d.]+) ms") > 0
    assert figure(running, "Hypothesis", r"([\d.]+)") >= 0
    before = nodes(running)
    until(running, WM_AT_LEAST, 12)
    assert nodes(running) > before
    lines = running.locator(".strip .u-wrap canvas").first.evaluate(
        """canvas => new Set(new Uint32Array(
            canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size"""
    )
    assert lines > 5


def test_pause_step_resume_and_stop(running: Page) -> None:
    until(running, WM_AT_LEAST, 2)
    running.locator("#run-toggle").click()
    state = running.locator(".run-state")
    expect(state).to_have_text("paused", timeout=SLOW)
    frame = re.compile(r"frame ([\d,]+)")
    banner = running.get_by_role("banner")

    def at() -> int:
        found = frame.search(banner.inner_text())
        assert found
        return int(found[1].replace(",", ""))

    running.wait_for_timeout(500)
    stood = at()
    running.wait_for_timeout(1000)
    assert at() == stood
    running.keyboard.press(".")
    expect(banner).to_contain_text(f"frame {stood + 1:,}", timeout=SLOW)
    expect(state).to_have_text("paused")
    running.keyboard.press(" ")
    expect(state).to_have_text("mapping", timeout=SLOW)
    running.locator("#run-stop").click()
    expect(state).to_have_text("stopped", timeout=SLOW)
    expect(running.locator("#run-toggle")).to_have_count(0)
    running.get_by_role("link", name="Params").click()
    expect(running.locator("#params-locked")).to_be_visible()
    try_values(running)


def try_values(page: Page) -> None:
    """On a finished map values are a draft: they are tried, compared, taken over, and the trial is discarded."""
    for name, value in (("Mem/STMSize", "2"), ("Vis/MinInliers", "30")):
        page.get_by_label(name, exact=True).fill(value)
        page.get_by_label(name, exact=True).press("Enter")
    expect(page.locator("#draft-bar")).to_contain_text("Mem/STMSize 10 → 2")
    expect(page.locator('[data-name="Mem/STMSize"] output')).to_have_text("10 nodes")
    page.locator("#draft-try").click()
    expect(page).to_have_url(re.compile(r"params/1\?tab=trials"))
    expect(page.locator('[data-measure="Largest STM"]')).to_contain_text("2", timeout=SLOW)
    expect(page.locator('[data-measure="Largest STM"]')).to_have_class("trial-differs")
    expect(page.get_by_role("img", name=re.compile("nodes from above"))).to_be_visible()
    page.locator("#trial-take-over").click()
    expect(page.get_by_role("status").filter(has_text="Taken over for the map's next session")).to_be_visible()
    expect(page.locator("#trial-take-over")).to_have_text("Taken over")
    expect(page.locator("#trial-take-over")).to_be_disabled()
    page.reload()
    expect(page.locator('[data-trial="1"]')).to_contain_text("older map")
    page.locator("#trial-discard").click()
    expect(page.get_by_text("Nothing was tried on this map yet")).to_be_visible()
    page.get_by_role("link", name="Change values").click()
    expect(page.locator('[data-name="Mem/STMSize"] output')).to_have_text("2 nodes")


def test_time_threshold_sends_nodes_to_long_term_memory(running: Page) -> None:
    running.get_by_role("link", name="Params").click()
    until(running, WM_AT_LEAST, 15)
    assert figure(running, "Memory", r"LTM ([\d,]+)") <= 0
    set_parameter(running, "Rtabmap/TimeThr", "1")
    expect(running.locator(".strip")).to_contain_text("TimeThr 1 ms")
    until(running, LTM_AT_LEAST, 3)


def test_a_value_out_of_bounds_is_refused_and_the_old_one_stays(running: Page) -> None:
    running.get_by_role("link", name="Params").click()
    field = running.get_by_label("Rtabmap/LoopThr", exact=True)
    field.fill("3")
    until(running, WM_AT_LEAST, 3)
    expect(field, "what is typed stays while the map grows").to_have_value("3")
    field.press("Enter")
    expect(running.get_by_role("status").filter(has_text="Rtabmap/LoopThr")).to_be_visible()
    expect(running.locator('[data-name="Rtabmap/LoopThr"] output')).to_contain_text("0.11")
    expect(field).to_have_value("0.11")


def test_loop_threshold_decides_whether_loops_come(running: Page) -> None:
    """At 1 no hypothesis is high enough; lowered again, loops are closed at once."""
    running.get_by_role("link", name="Params").click()
    set_parameter(running, "Rtabmap/LoopThr", "1")
    expect(running.locator(".strip")).to_contain_text("LoopThr 1")
    # The second round begins at about node 70.
    until(running, WM_AT_LEAST, 75)
    expect(running.locator('[data-name="Rtabmap/LoopThr"] .foresight')).to_contain_text("reached by 0 of")
    closed = figure(running, "Hypothesis", r"▾ ([\d,]+)")
    set_parameter(running, "Rtabmap/LoopThr", "0.11")
    until(running, "n => Number(/▾ ([\\d,]+)/.exec(document.querySelector('.strip').innerText)?.[1]) >= n", closed + 5)
    running.get_by_role("link", name="Loops", exact=True).click()
    expect(running.get_by_role("row").filter(has_text="global").first).to_be_visible(timeout=SLOW)
