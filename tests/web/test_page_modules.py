"""Laws of the page's own modules, in a real browser, without a server behind them."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from playwright.sync_api import Browser, Page, Route

from tests.web.conftest import until

WEB = Path(__file__).resolve().parents[2] / "web"


class Quiet(SimpleHTTPRequestHandler):
    """Serves files without a word."""

    def log_message(self, format: str, *args: object) -> None:  # the name is the base class's
        """Nobody reads it."""


@pytest.fixture(scope="module")
def static_web() -> Iterator[str]:
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(WEB)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_address[1]}/"
    server.shutdown()
    server.server_close()


@pytest.fixture
def modules(browser: Browser, static_web: str) -> Iterator[Page]:
    """A page with the import map, in which nothing has started."""
    page = browser.new_page()

    def no_app(route: Route) -> None:
        route.fulfill(body="", content_type="text/javascript")

    page.route("**/app.js", no_app)
    page.goto(static_web)
    yield page
    page.close()


def call(page: Page, module: str, expression: str, argument: Any = None) -> Any:
    """Value of an expression in which ``m`` is a module of the page and ``a`` the argument."""
    return page.evaluate(f"async (a) => {{ const m = await import('./{module}'); return {expression}; }}", argument)


@pytest.mark.parametrize(
    "route",
    [
        {"map": "tour", "view": "loops", "key": "147-61", "query": {}},
        {"map": "lab 3/été #1", "view": "nodes", "key": "12", "query": {}},
        {"map": "a%b", "view": "stats", "key": None, "query": {"names": "Timing/Total/ms,Loop/Id/"}},
        {"map": None, "view": "maps", "key": None, "query": {}},
    ],
)
def test_a_link_reopens_what_it_names(modules: Page, route: dict[str, Any]) -> None:
    parsed = call(
        modules,
        "router.js",
        "(({query, ...rest}) => ({...rest, query: Object.fromEntries(query)}))(m.parse(m.link(a)))",
        route,
    )
    assert parsed == route


@pytest.mark.parametrize(
    "filter",
    [
        {"states": ["added", "refused"], "suspect": True, "type": "GlobalClosure", "minInliers": 40, "session": 0},
        {"ranges": {"doubt": [1, None], "residual_sigma": [None, 2.5], "graph_distance": [0, 30]}},
    ],
)
def test_a_filter_of_the_queue_is_in_its_address(modules: Page, filter: dict[str, Any]) -> None:
    whole = {**call(modules, "loop_list.js", "m.NO_FILTER"), **filter}
    assert call(modules, "loop_query.js", "m.filterOf(new URLSearchParams(m.queryOf(a)))", whole) == whole


@pytest.mark.parametrize("query", ["", "tab=jobs", "at=12&from=3&to=4", "inliers=many&session=&in-doubt=..&in-no=1.."])
def test_an_address_without_a_filter_names_none(modules: Page, query: str) -> None:
    assert call(modules, "loop_query.js", "m.filterOf(new URLSearchParams(a))", query) is None


def test_a_row_that_is_here_is_found_and_told_of_at_once(modules: Page) -> None:
    code = """(() => {
        const rows = Object.assign(new m.Window("tour"), {loaded: true});
        rows.pages.set(0, a.map((id) => ({id})));
        const [before, at] = [rows.revision.value, rows.indexOf(a[1])];
        rows.seek(a[1]);
        return [at, rows.indexOf(a[1]), rows.indexOf(a[1] + 1), rows.revision.value > before];
    })()"""
    assert call(modules, "window.js", code, [5, 7]) == [1, 1, -1, True]


_CLOUD = """(() => {
  let state = a.seed + 1;
  const next = () => (state = (state * 48271) % 2147483647) / 2147483647;
  const [count, width, height] = [400, 160, 120];
  const points = Float32Array.from({ length: 3 * count }, () => 4 * next());
  const cloud = { count, points, colours: new Uint8Array(3 * count).fill(200) };
  const view = m.zoomed(m.turned(m.firstView(cloud), a.yaw, a.pitch), a.zoom);
  const image = new ImageData(width, height);
  const shown = m.drawCloud(image, cloud, view);
  const of = (k) => m.project(view, width, height, points.subarray(3 * k, 3 * k + 3));
  const apart = (p, q) => Math.hypot(p.x - q.x, p.y - q.y);
  const drawn = [...shown.keys()].filter((at) => shown[at] >= 0);
  const inside = ({ at }) => at && at.x >= 0 && at.y >= 0 && at.x <= width - 1 && at.y <= height - 1;
  const clicks = [...Array(count).keys()].map((k) => ({ k, at: of(k) })).filter(inside);
  const picked = clicks.map(({ at }) => m.pointNear(shown, width, at.x, at.y, 3));
  const near = (k, { at }) => of(k).depth <= at.depth + 1e-3 || apart(of(k), at) < 12;
  return {
    coloured: image.data.filter((value) => value > 0).length === 4 * drawn.length,
    far: Math.max(0, ...drawn.map((at) => apart(of(shown[at]), { x: at % width, y: Math.floor(at / width) }))),
    inFront: picked.every((k, i) => k >= 0 && near(k, clicks[i])),
    missed: m.pointNear(new Int32Array(width * height).fill(-1), width, 5, 5, 9),
  };
})()"""


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 10_000), st.floats(-3, 3), st.floats(-1.5, 1.5), st.floats(0.3, 3))
def test_a_click_on_a_cloud_picks_a_point_that_is_to_be_seen_there(
    modules: Page, seed: int, yaw: float, pitch: float, zoom: float
) -> None:
    found = call(modules, "orbit.js", _CLOUD, {"seed": seed, "yaw": yaw, "pitch": pitch, "zoom": zoom})
    assert found["coloured"] and found["inFront"] and found["missed"] == -1
    assert found["far"] < 10, "a point is drawn where it is"


def test_what_may_come_later_waits_until_nobody_waits_for_an_answer(modules: Page) -> None:
    held: list[Route] = []

    def hold(route: Route) -> None:
        held.append(route)

    modules.route("**/api/slow", hold)
    start = """async () => {
        const m = await import("./api.js");
        window.quiet = false;
        void m.get("/api/slow", {}).catch(() => null);
        void m.whenQuiet().then(() => (window.quiet = true));
        await new Promise((resolve) => setTimeout(resolve, 50));
        return window.quiet;
    }"""
    assert modules.evaluate(start) is False
    while not held:
        modules.wait_for_timeout(20)
    held[0].fulfill(json={})
    until(modules, "() => window.quiet")
    assert modules.evaluate("import('./api.js').then((m) => m.whenQuiet())") is None


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
def test_of_two_points_behind_each_other_the_nearer_is_picked(modules: Page, order: list[int]) -> None:
    code = """(() => {
        const both = [[0, 0, 0], [1, 0, 0]];
        const cloud = { count: 2, points: Float32Array.from(a.flatMap((k) => both[k])), colours: new Uint8Array(6) };
        const view = { yaw: 0, pitch: 0, distance: 2, target: [0, 0, 0] };
        const shown = m.drawCloud(new ImageData(160, 120), cloud, view);
        return a[m.pointNear(shown, 160, 80, 60, 5)];
    })()"""
    assert call(modules, "orbit.js", code, order) == 0


def test_points_come_as_rows_of_sixteen_bytes(modules: Page) -> None:
    code = """(() => {
        const rows = new ArrayBuffer(32);
        new Float32Array(rows).set([1, 2, 3], 0);
        new Float32Array(rows).set([4, 5, 6], 4);
        new Uint8Array(rows).set([7, 8, 9], 12);
        new Uint8Array(rows).set([10, 11, 12], 28);
        const { points, colours, count } = m.cloudOf(rows);
        return [count, [...points], [...colours]];
    })()"""
    assert call(modules, "parts/cloud_picker.js", code) == [2, [1, 2, 3, 4, 5, 6], [7, 8, 9, 10, 11, 12]]


@pytest.mark.parametrize("text", ["", "#", "#/nowhere", "#/map", "#/map/tour/nowhere/5", "#/%E0%A4%A"])
def test_any_address_leads_to_a_view(modules: Page, text: str) -> None:
    parsed = call(modules, "router.js", "m.parse(a)", text)
    assert parsed["view"] in ("maps", "loops")


@pytest.mark.parametrize(
    "entry",
    [
        {"type": "float", "minimum": 0, "maximum": 1, "default": 0.11, "value": 0.2},
        {"type": "float", "minimum": 0, "maximum": None, "default": 0, "value": 700},
        {"type": "int", "minimum": 1, "maximum": None, "default": 10, "value": 30},
        {"type": "int", "minimum": 4, "maximum": None, "default": 20, "value": 5000},
        {"type": "float", "minimum": 1e-6, "maximum": 1, "default": 0.001, "value": 0.001},
    ],
)
def test_a_slider_reaches_bounds_and_the_value_in_force(modules: Page, entry: dict[str, Any]) -> None:
    script = """(() => {
      const r = m.sliderRange(a, a.value);
      const steps = Array.from({length: r.steps + 1}, (_, i) => i);
      return {values: steps.map(r.fromStep), back: steps.map(i => r.toStep(r.fromStep(i))), at: r.toStep(a.value)};
    })()"""
    found = call(modules, "parts/slider_range.js", script, entry)
    values = found["values"]
    assert values == sorted(values)
    assert values[0] == pytest.approx(entry["minimum"], abs=1e-3)
    assert entry["maximum"] is None or values[-1] == pytest.approx(entry["maximum"])
    assert values[-1] >= entry["value"]
    assert 0 <= found["at"] < len(values)
    assert all(abs(step - back) <= 1 for step, back in enumerate(found["back"]) if values.count(values[step]) == 1)
    if entry["type"] == "int":
        assert all(float(value).is_integer() for value in values)


@pytest.mark.parametrize(
    ("metres", "text"), [(None, "—"), (0.0041, "4.1 mm"), (-0.0041, "−4.1 mm"), (0.041, "4.1 cm"), (12.3456, "12.35 m")]
)
def test_lengths_have_the_unit_that_suits_them(modules: Page, metres: float | None, text: str) -> None:
    assert call(modules, "format.js", "m.length(a)", metres) == text


def test_angles_of_a_known_rotation(modules: Page) -> None:
    quarter_about_z = [0, 0, 0, 0, 0, 0.5**0.5, 0.5**0.5]
    assert call(modules, "parts/pose.js", "m.rollPitchYaw(a)", quarter_about_z) == pytest.approx([0, 0, 90])


def test_columns_grow_by_what_is_new_and_stay_in_step(modules: Page) -> None:
    """Rows arrive while a column is being added: every column ends with the same rows, none twice."""
    asked: list[str] = []
    rows = 5

    def answer(route: Route) -> None:
        nonlocal rows
        query = route.request.url.split("?")[1]
        asked.append(query)
        after = int(query.split("after=")[1])
        ids = list(range(after + 1, rows + 1))
        rows += 1
        names = query.split("names=")[1].split("&")[0].split("%2C")
        route.fulfill(json={"ids": ids, "stamps": ids, "values": dict.fromkeys(names, ids)})

    modules.route("**/api/maps/tour/statistics*", answer)
    script = """(async () => {
      const columns = new m.Columns("tour");
      columns.want(["one"]); await columns.queue;
      columns.pull(); columns.want(["two"]); await columns.queue;
      columns.pull(); await columns.queue;
      return [columns.ids, columns.column("one"), columns.column("two"), columns.last("two")];
    })()"""
    ids, one, two, last = call(modules, "columns.js", script)
    assert ids == one == two == list(range(1, len(ids) + 1))
    assert last == ids[-1]
    assert "after=0" not in asked[-1], "only what is new is fetched"


@given(values=st.lists(st.integers(1, 100), min_size=20, max_size=150), spike=st.integers(1, 10**6))
@example(values=[30] * 122, spike=380)
@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_only_one_value_in_a_hundred_is_cut_off_a_chart_and_only_if_it_flattens_the_rest(
    modules: Page, values: list[int], spike: int
) -> None:
    found = call(modules, "parts/chart_range.js", "m.ceiling([a])", [*values, None, spike])
    most = sorted([*values, spike], reverse=True)
    if found is not None:
        above = [value for value in most if value > found]
        assert 1 <= len(above) <= max(1, len(most) // 100) and min(above) > 4 * found
        assert found in most
    elif len(most) < 200:
        assert most[0] <= 4 * most[1]
    assert call(modules, "parts/chart_range.js", "m.ceiling([a], 0, 18)", values) is None


def test_a_time_axis_has_no_label_in_the_corner(modules: Page) -> None:
    labels = "m.seconds({valToPos: (at) => at * a}, [0, 10, 60, 120, 605])"
    assert call(modules, "parts/chart.js", labels, 2) == ["", "10 s", "60 s", "2:00", "10:05"]
    assert call(modules, "parts/chart.js", labels, 0.5)[:2] == ["", ""], "nor one that would reach into it"
