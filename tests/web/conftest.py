"""A real browser on the real server for the tests of the page; they are skipped where there is no browser."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Literal

import pytest
from playwright.sync_api import Browser, ConsoleMessage, Error, Page, Route, ViewportSize, expect, sync_playwright

from tests.web.served import SMALL_TOUR, Served, make_map

#: Chromium renders WebGL without a graphics card with these.
FLAGS = (
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--no-first-run",
)
VIEWPORT: ViewportSize = {"width": 1280, "height": 720}

OpenPage = Callable[..., Page]

#: Drawing in software keeps a small machine busy: patience costs nothing where all is well.
PATIENCE_MS = 30_000
expect.set_options(timeout=PATIENCE_MS)


def until(page: Page, condition: str, argument: object = None, seconds: float = 90.0) -> None:
    """Waits until a function of JavaScript is true; Playwright's own way needs what the page's policy forbids."""
    deadline = time.monotonic() + seconds
    while not page.evaluate(condition, argument):
        assert time.monotonic() < deadline, f"not within {seconds:g} s: {condition}"
        page.wait_for_timeout(200)


def chromium() -> str | None:
    """Path of Chromium, or of the browser that CHROMIUM names; None where there is none."""
    return os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")


@pytest.fixture(scope="session", autouse=True)
def cache_of_the_tests(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Servers keep what can be made again (trials) here, not in the person's own cache."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Chromium, or the browser that CHROMIUM names."""
    executable = chromium()
    if executable is None:
        pytest.skip("needs Chromium: install the package chromium, or set CHROMIUM to its path")
    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=executable, args=list(FLAGS))
        yield running
        running.close()


@pytest.fixture(scope="session")
def finished_map(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A map of the small tour with loops in it; tests that change it take a copy."""
    path = tmp_path_factory.mktemp("made") / "flat.db"
    make_map(path, f"{SMALL_TOUR},frames=290")
    return path


@pytest.fixture(scope="session")
def library(finished_map: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server of a folder with that map, and with a file that is none; nobody changes anything here."""
    folder = tmp_path_factory.mktemp("maps")
    shutil.copy(finished_map, folder / "flat.db")
    (folder / "broken.db").write_text("hello")
    server = Served("serve", str(folder), "--port", "0")
    yield server
    server.close()


@pytest.fixture
def open_page(browser: Browser) -> Iterator[OpenPage]:
    """Opens a server's page at a place (a hash); what goes wrong in the page fails the test.

    The 3D view stays empty unless ``in_3d``: drawing it in software would take most of the time. Hints for the first
    visit are there only if it is the ``first``.
    """
    contexts = []
    wrong: list[str] = []

    def leave_empty(route: Route) -> None:
        # Without this header the browser keeps it from the isolated frame around it, as it does with errors.
        headers = {"Content-Type": "text/html", "Document-Isolation-Policy": "isolate-and-require-corp"}
        route.fulfill(body='<!doctype html><div id="root"></div>', headers=headers)

    def note_error(error: Error) -> None:
        # viser tries whether it may compile text into code, and does without when it may not.
        if "unsafe-eval" not in str(error):
            wrong.append(str(error))

    def note_refusal(said: ConsoleMessage) -> None:
        if "Content Security Policy" in said.text and "unsafe-eval" not in said.text:
            wrong.append(said.text)

    def opened(
        server: Served,
        place: str = "",
        theme: Literal["dark", "light"] = "dark",
        *,
        in_3d: bool = False,
        first: bool = False,
    ) -> Page:
        context = browser.new_context(viewport=VIEWPORT, color_scheme=theme)
        contexts.append(context)
        if not first:
            context.add_init_script("localStorage.setItem('slamdeck.tour-seen', 'true')")
        page = context.new_page()
        page.set_default_timeout(PATIENCE_MS)
        if not in_3d:
            page.route("**/viser/**", leave_empty)
        page.on("pageerror", note_error)
        page.on("console", note_refusal)
        page.goto(server.url)
        if place:
            page.goto(server.base + place)
        return page

    yield opened
    for context in contexts:
        context.close()
    assert not wrong
