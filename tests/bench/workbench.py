"""``python -m tests.bench --workbench``: the page's figures, by a real server and a real browser.

Maps are made for it: 2,000 nodes with 200 loops, and 10,000 nodes with 12,000 links and a million points.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from playwright.sync_api import Browser, Error

from server.scene.cloud_points import points_of_each
from tests.bench.drained import DrainedView
from tests.bench.figures import Figure, most
from tests.bench.planting import PLANTED, QUEUE, Planting, maps, plantings, summary
from tests.bench.watched import WatchedPage, chromium
from tests.bench.workbench_map import write_workbench_map
from tests.web.served import Served

_MANY, _LOOPS, _CLOUDS = 10_000, 2_001, 100
_FEW, _FEW_LOOPS, _FEW_CLOUDS = 2_000, 200, 40
_PLANTINGS, _TIMES = 100, 5
#: No map takes longer than about this, which is enough for all plantings in each.
_PLANTING_S = 1500.0
_MEGA = 1e6
#: The answer may be read a little after the 3D view moved.
_LEAD_S = 0.1
#: What comes over a stream within this time is one update.
_TOGETHER_S = 0.01
#: How long the timeline's slider is drawn, moving every 16 ms as by a mouse, and how often the 3D view has to follow.
_SCRUB_S, _UPDATES_PER_S = 4.0, 20.0
_FETCH = """async (path) => {
  const start = performance.now();
  await (await fetch(path, { signal: AbortSignal.timeout(60000) })).json();
  return performance.now() - start;
}"""


def workbench(data: Path, kept: Path, names: Sequence[str], count: int = _PLANTINGS) -> Iterator[Figure]:
    """All figures, as they come; those of the browser are left out where there is none.

    Args:
        data: folder with pose graphs and databases of others.
        kept: folder of the maps that are made for it; those that are there are used again, in copies.
        names: of the maps in which false loops are planted; all where there is none.
        count: plantings in each map.
    """
    executable = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
    if executable is None:
        yield Figure("the page", "needs Chromium", "")
    else:
        with tempfile.TemporaryDirectory() as folder, chromium(executable) as browser:
            for name, of in (("few", (_FEW, _FEW_LOOPS, _FEW_CLOUDS)), ("many", (_MANY, _LOOPS, _CLOUDS))):
                shutil.copy(_made(kept, *of), Path(folder) / f"{name}.db")
            yield from pages(browser, Path(folder))
    for name in maps(data):
        if count and (name in names or not names):
            yield from planting(data, name, count)


def _made(kept: Path, nodes: int, loops: int, clouds: int) -> Path:
    """A map of that size, made unless it is there."""
    path = kept / f"{nodes}-{loops}-{clouds}-near.db"
    if not path.is_file():
        kept.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(".part")
        part.unlink(missing_ok=True)
        write_workbench_map(part, nodes, loops, clouds)
        part.replace(path)
    return path


def planting(data: Path, name: str, count: int) -> list[Figure]:
    """Whether planted false loops are found in one map, and what that costs; no new one is begun after a while."""
    graph, params = maps(data)[name]()
    deadline = time.monotonic() + _PLANTING_S
    made: list[Planting] = []
    for one in plantings(graph, params, count):
        made.append(one)
        if time.monotonic() > deadline:
            break
    found = summary(made)
    share, loops = found["found_percent"], sum(link.type.is_loop for link in graph.links.values())
    text = f"{PLANTED} false loops in {name} ({loops} loops), among the first {QUEUE} of {found['plantings']} plantings"
    off = f"{name}: how far the map is off after they were rejected, at most (planted: {found['bent_m']:g} m)"
    return [
        Figure(text, share, "%", "", ">= 95", share >= 95.0),
        most(off, found["mended_m"], "m", "", 0.01),
        most(f"{name}: all loops judged, median", found["seconds"], "s", "", 1.0),
    ]


def pages(browser: Browser, folder: Path) -> Iterator[Figure]:
    """Figures of the page on maps ``few.db`` and ``many.db`` of a folder, as they come; what never came is said."""
    for part in (_opened, _decided, _scrubbed):
        server = Served("serve", str(folder), "--port", "0")
        try:
            yield from part(browser, server)
        except (TimeoutError, Error) as error:
            yield Figure(
                f"the page, {part.__name__.strip('_')}: {str(error).splitlines()[0]}", None, "", "", "", met=False
            )
        finally:
            # The maps are copies: nothing is lost with a server that does not end in time on a busy machine.
            server.kill()


def _opened(browser: Browser, server: Served) -> list[Figure]:
    """A new browser on the large map, then a loop closure: the worst loop goes."""
    watched = WatchedPage(browser, server)
    page, port = watched.page, watched.port
    start = time.monotonic()
    page.goto(f"{watched.base}#/map/many/loops")
    page.get_by_role("table", name="Loop closures").get_by_role("row").nth(3).wait_for()
    ready = time.monotonic() - start
    watched.wait(lambda: port.views > 0)
    watched.quiet()
    # Of a cloud's 10,000 points fewer are shown where there are many clouds.
    points = f"{_CLOUDS * 10_000:,} points, {_CLOUDS * min(10_000, points_of_each(_CLOUDS)):,} of them shown"
    name, slowest = f"{_MANY:,} nodes, {_MANY + _LOOPS - 1:,} links, {points}", _slowest(watched)
    shown = Figure("the same: of these to the 3D view", round(port.views / _MEGA, 2), "MB")
    found = [
        most(f"{name}: all bytes to a new browser", round(port.bytes / _MEGA, 2), "MB", "", 15.0),
        shown,
        most(f"{name}: page shows the review queue", round(ready, 2), "s", "", 2.0),
        slowest,
    ]
    port.reset()
    rejected = _reject(watched)
    watched.quiet()
    closed = most("the same: all bytes after a loop was rejected", round(port.bytes / _MEGA, 2), "MB", "", 1.0)
    task = "the same, until then: longest task of the page's main thread"
    longest = most(task, round(watched.longest_task_ms()), "ms", "", 200.0)
    watched.close()
    return [*found, closed, longest, Figure("the same: decision to new graph on the page", round(rejected, 2), "s")]


def _slowest(watched: WatchedPage) -> Figure:
    url, seconds = max(watched.requests, key=lambda one: one[1])
    what = "/".join(url.split("?")[0].split("/")[3:])
    return most(f"the same: slowest request ({what})", round(seconds, 2), "s", "", 1.0)


def _decided(browser: Browser, server: Served) -> list[Figure]:
    """Decisions on the map of 2,000 nodes, and what another threshold would mean."""
    watched = WatchedPage(browser, server)
    page = watched.page
    page.goto(f"{watched.base}#/map/few/loops")
    page.get_by_role("table", name="Loop closures").get_by_role("row").nth(3).wait_for()
    watched.wait(lambda: watched.port.views > 0)
    watched.quiet()
    _reject(watched)
    spent = [_reject(watched) for _ in range(_TIMES)]
    what_if = [_timed(watched, f"api/maps/few/what-if/loops?loop_thr={0.3 + 0.1 * k:g}&graph=true") for k in range(5)]
    watched.close()
    decided = f"decision to new graph on the page, {_FEW:,} nodes, median of {_TIMES}"
    return [
        most(decided, round(float(np.median(spent)), 2), "s", "", 0.5),
        most(f"LoopThr what-if, {_FEW:,} nodes, verified", round(float(np.median(what_if)), 2), "s", "", 0.2),
    ]


def _reject(watched: WatchedPage) -> float:
    """Seconds from the key to the first change in the 3D view; the next loop of the queue is selected after it."""
    page, port = watched.page, watched.port
    page.get_by_role("table", name="Loop closures").get_by_role("row").nth(3).click()
    page.locator("#reject:enabled").wait_for()
    watched.quiet()
    port.reset()
    start = time.monotonic()
    with page.expect_response(lambda answer: answer.url.endswith("/decisions")):
        page.keyboard.press("r")
    answered = time.monotonic()
    watched.wait(lambda: any(when > answered - _LEAD_S for when in port.moments))
    return max(answered, next(when for when in port.moments if when > answered - _LEAD_S)) - start


def _timed(watched: WatchedPage, path: str) -> float:
    return float(watched.page.evaluate(_FETCH, path)) / 1e3


def _scrubbed(browser: Browser, server: Served) -> list[Figure]:
    """Moments asked for by HTTP, as fast as they are taken, and what of them reaches a window that shows the graph.

    The slider itself is not moved: a page that is drawn in software is repainted a few times a second.
    """
    watched = WatchedPage(browser, server)
    page, port = watched.page, watched.port
    page.goto(f"{watched.base}#/map/few/stats")
    page.locator('[aria-label="Update that is shown"]:enabled').wait_for()
    watched.wait(lambda: port.views > 0)
    page.get_by_role("button", name="Cloud", exact=True).click()
    watched.quiet()
    viewer = page.evaluate("sessionStorage['slamdeck.viewer']")
    port.reset()
    start, asked = time.monotonic(), 0
    while time.monotonic() - start < _SCRUB_S:
        change = {"at": _moment(asked)}
        headers = {"Origin": server.base.rstrip("/")}
        answer = page.request.patch(f"{server.base}api/scene/few?viewer={viewer}", data=change, headers=headers)
        if not answer.ok:
            raise Error(answer.text())
        asked += 1
    watched.quiet()
    pace, moves = round(_updates(port.moments) / _SCRUB_S, 1), round(asked / _SCRUB_S)
    watched.close()
    name = f"scrubbing the timeline, {_FEW:,} nodes: updates of the 3D view, of {moves} moments asked for a second"
    return [Figure(name, pace, "1/s", "", f">= {_UPDATES_PER_S:g}", pace >= _UPDATES_PER_S), _drained(server)]


def _drained(server: Served) -> Figure:
    """The same for a window on another machine, whose drawing takes nothing from the server."""
    view = DrainedView(server, "few")
    view.quiet()
    view.moments.clear()
    start, asked = time.monotonic(), 0
    while time.monotonic() - start < _SCRUB_S:
        view.change(at=_moment(asked))
        asked += 1
    view.quiet()
    pace, moves = round(_updates(view.moments) / _SCRUB_S, 1), round(asked / _SCRUB_S)
    view.close()
    name = f"the same: sent to a window that does not draw on this machine, of {moves} moments asked for a second"
    return Figure(name, pace, "1/s")


def _moment(asked: int) -> int:
    """Where the slider is when it was moved so many times."""
    return 1 + 7 * asked % _FEW


def _updates(moments: list[float]) -> int:
    """Parts of a stream that came together are one."""
    return 1 + int((np.diff(moments) > _TOGETHER_S).sum()) if moments else 0
