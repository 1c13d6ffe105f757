"""A page in a real browser whose bytes, requests and long tasks are counted."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from playwright.sync_api import Browser, Page, Request, sync_playwright

from tests.bench.counted_port import CountedPort
from tests.web.conftest import FLAGS, VIEWPORT
from tests.web.served import Served

#: 3D views draw in software here, on the cores that the server needs: the view is there and gets all, but is tiny.
_UNSEEN = """
addEventListener("DOMContentLoaded", () => {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(".scene-frame { width: 8px !important; height: 8px !important }");
  document.adoptedStyleSheets = [sheet];
});
localStorage.setItem("slamdeck.tour-seen", "true");
window.longTasks = [];
new PerformanceObserver((list) => {
  for (const entry of list.getEntries()) window.longTasks.push(entry.duration);
}).observe({ type: "longtask", buffered: true });
"""
_QUIET_S = 1.5
_PATIENCE_S = 60.0


@contextmanager
def chromium(executable: str) -> Iterator[Browser]:
    """The browser."""
    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=executable, args=list(FLAGS))
        yield running
        running.close()


class WatchedPage:
    """A page with an empty cache.

    Attributes:
        page: it.
        port: what it comes through.
        base: address of the page there.
        requests: address and seconds of each answer.
    """

    def __init__(self, browser: Browser, server: Served) -> None:
        self.port = CountedPort(int(server.base.split(":")[2].split("/")[0]))
        self.base = f"http://127.0.0.1:{self.port.port}/"
        self.requests: list[tuple[str, float]] = []
        self._waiting: set[Request] = set()
        self._context = browser.new_context(viewport=VIEWPORT)
        self._context.add_init_script(_UNSEEN)
        self.page: Page = self._context.new_page()
        self.page.set_default_timeout(1000 * _PATIENCE_S)
        self.page.on("request", lambda request: self._waiting.add(request))
        self.page.on("requestfailed", lambda request: self._waiting.discard(request))
        self.page.on("requestfinished", self._finished)
        self.page.goto(f"{self.base}?{server.url.split('?')[1]}")

    def close(self) -> None:
        """Forget all of it."""
        self._context.close()
        self.port.close()

    def quiet(self) -> None:
        """Wait until every request is answered and nothing came for some seconds."""
        self.port.last = time.monotonic()
        self.wait(lambda: not self._waiting and time.monotonic() - self.port.last > _QUIET_S)

    def wait(self, known: Callable[[], bool]) -> None:
        """Wait until something is true; raises TimeoutError."""
        deadline = time.monotonic() + _PATIENCE_S
        while not known():
            if time.monotonic() > deadline:
                raise TimeoutError(f"{self.page.url} was not ready within {_PATIENCE_S:g} s")
            self.page.wait_for_timeout(20)

    def longest_task_ms(self) -> float:
        """Of the main thread, since the page was opened."""
        return float(self.page.evaluate("() => Math.max(0, ...window.longTasks)"))

    def _finished(self, request: Request) -> None:
        self._waiting.discard(request)
        self.requests.append((request.url, max(0.0, request.timing["responseEnd"]) / 1e3))
