"""The server or the engine dies: the page says so, says what to do, and goes on by itself."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
from pathlib import Path

import pytest
from playwright.sync_api import Route, expect

from tests.web.conftest import OpenPage, until
from tests.web.served import SMALL_TOUR, Served

SLOW = 60_000


def children(pid: int) -> list[int]:
    """Processes that a process has started."""
    found = subprocess.run(["pgrep", "--parent", str(pid)], capture_output=True, text=True, check=False)
    return [int(line) for line in found.stdout.split()]


def engine_pids(server: Served) -> list[int]:
    """The server's engines: split off a process that the server has started."""
    if shutil.which("pgrep") is None:
        pytest.skip("needs pgrep to find the engine's process")
    return [pid for child in children(server.process.pid) for pid in children(child)]


def test_a_server_that_is_gone_is_said_and_reconnected_to(
    finished_map: Path, tmp_path: Path, open_page: OpenPage
) -> None:
    (tmp_path / "flat.db").write_bytes(finished_map.read_bytes())
    server = Served("serve", str(tmp_path), "--port", "0", "--no-token")
    page = open_page(server, "#/map/flat/loops")
    expect(page.get_by_role("row").nth(1)).to_be_visible()
    server.kill()
    gone = page.locator("#server-gone")
    expect(gone).to_contain_text("slamdeck serve", timeout=SLOW)
    expect(page.get_by_role("row").nth(1)).to_be_visible()  # what had arrived stays
    port = re.search(r":(\d+)", server.base)
    assert port
    again = Served("serve", str(tmp_path), "--port", port[1], "--no-token")
    try:
        expect(gone).to_be_hidden(timeout=SLOW)
    finally:
        again.close()


def test_a_3d_view_that_does_not_come_says_so_and_is_tried_again(library: Served, open_page: OpenPage) -> None:
    page = open_page(library, "#/map/flat/nodes")
    gone = page.locator(".scene-gone")
    for document in ("**/viser/**", "**/frame.html*"):

        def refuse(route: Route) -> None:
            route.fulfill(status=500, body="{}", content_type="application/json")

        page.route(document, refuse)
        page.reload()
        expect(gone).to_contain_text("The 3D view did not come")
        page.unroute(document, refuse)
        gone.get_by_role("button", name="Try again").click()
        view = page.frame_locator("iframe.scene-frame").frame_locator("iframe")
        expect(view.locator("#root")).to_be_attached()
        expect(gone).to_be_hidden()


def test_a_browser_without_a_valid_token_is_told_where_to_get_one(
    finished_map: Path, tmp_path: Path, open_page: OpenPage
) -> None:
    (tmp_path / "flat.db").write_bytes(finished_map.read_bytes())
    server = Served("serve", str(tmp_path), "--port", "0")
    page = open_page(server, "#/map/flat/loops")
    expect(page.get_by_role("row").nth(1)).to_be_visible()
    server.close()
    port = re.search(r":(\d+)", server.base)
    assert port
    again = Served("serve", str(tmp_path), "--port", port[1])
    try:
        expect(page.locator("#expired")).to_contain_text("token", timeout=SLOW)
    finally:
        again.close()


def test_a_dead_engine_leaves_page_and_map_alive(tmp_path: Path, open_page: OpenPage) -> None:
    server = Served("run", SMALL_TOUR, "--db", str(tmp_path / "live.db"), "--serve", "--port", "0")
    page = open_page(server)
    try:
        expect(page).to_have_url(re.compile("#/map/live"), timeout=SLOW)
        until(page, "() => Number(/node ([\\d,]+)/.exec(document.querySelector('header').innerText)?.[1]) >= 5")
        (engine,) = engine_pids(server)
        os.kill(engine, signal.SIGKILL)
        banner = page.locator("#engine-dead")
        expect(banner).to_contain_text("The engine stopped", timeout=SLOW)
        expect(banner).to_contain_text("start a new run")
        page.get_by_role("link", name="Nodes").click()
        page.get_by_role("row").nth(2).click()
        expect(page.get_by_role("region", name=re.compile(r"Node \d+"))).to_be_visible()
        banner.get_by_role("button", name="Hide this message").click()
        expect(banner).to_be_hidden()
    finally:
        server.close()
