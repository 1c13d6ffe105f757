"""A view follows its map and what people choose, and tells what they click."""

from __future__ import annotations

import gc
import shutil
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from server.browse.asked import Asked
from server.browse.map_view import MapView
from server.catalog import MapFile
from server.hub import Hub
from server.scene.scene import MapScene
from server.scene.scenes import Scenes
from server.schemas.scene import Scene, SceneChange
from slam.database import MapReader, MapWriter
from slam.tools.floor_plan import floor_plan
from tests.unit.server.loop_map import write_loop_map
from tests.unit.server.scene.conftest import Sent
from tests.unit.server.scene.room_map import LAP, NODES, true_pose, write_room_map
from tests.unit.server.scene.test_batched import click

Selections = list[tuple[str, tuple[int, ...]]]


class Watched:
    """A view on a map file, and what was clicked in it."""

    def __init__(self, path: Path) -> None:
        self.selections: Selections = []
        self.view = MapView(MapFile(path.stem, path.name, path))
        self.scene = MapScene(self.view, lambda kind, ids: self.selections.append((kind, ids)))

    def handle(self, name: str) -> Any:
        return self.api.get_handle_by_name(name)

    @property
    def api(self) -> Any:
        return self.scene._painter._viewer.scene

    def change(self, **change: Any) -> Any:
        return self.scene.change(SceneChange.model_validate(change))

    def wait(self) -> None:
        """Until all that was asked for is drawn: layers are drawn one after the other by another thread."""
        painter = self.scene._painter
        until(lambda: painter._shown is not None and painter._shown.state == self.scene.state())


def until(true: Callable[[], Any]) -> None:
    """Waits for the thread that draws."""
    end = time.monotonic() + 30
    while not true():
        assert time.monotonic() < end, "the view was not drawn"
        time.sleep(0.02)


@pytest.fixture
def open_scene() -> Iterator[Callable[[Path], Watched]]:
    opened: list[Watched] = []

    def start(path: Path) -> Watched:
        opened.append(Watched(path))
        return opened[-1]

    yield start
    for watched in opened:
        watched.scene.close()


@pytest.fixture
def watched(open_scene: Callable[[Path], Watched], room_map: Path) -> Watched:
    """The room's map, drawn with all its clouds."""
    found = open_scene(room_map)
    until(lambda: found.handle("/cloud/12"))
    until(lambda: not found.scene._painter._clouds.missing)
    return found


def test_a_view_shows_the_graph_the_clouds_and_the_newest_pose(watched: Watched) -> None:
    assert len(watched.handle("/graph/nodes/0").batched_positions) == NODES
    assert watched.handle("/paths/odometry/0").visible
    assert watched.handle("/paths/truth/0") is None
    np.testing.assert_allclose(watched.handle("/newest").position, true_pose(NODES)[:3, 3], atol=1e-6)
    until(lambda: watched.handle("/ground").position[2] == pytest.approx(-1.2, abs=0.1))


def test_clouds_let_pass_who_waits_for_an_answer(room_map: Path) -> None:
    view = MapView(MapFile("room", "room", room_map))
    # A clock that stands: the request stays a short one.
    view.asked = Asked(lambda: 0.0)
    with ExitStack() as open_scenes:
        with view.asked.one():
            scene = MapScene(view, lambda _, __: None)
            open_scenes.callback(scene.close)
            painter = scene._painter
            until(lambda: painter._shown is not None)
            scene.change(SceneChange(dark=False))
            until(lambda: painter._shown is not None and painter._shown.state == scene.state())
            assert not painter._clouds._handles
        until(lambda: painter._clouds._handles and not painter._clouds.missing)


def test_a_floor_plan_that_is_not_stored_is_put_together_of_the_local_grids(
    open_scene: Callable[[Path], Watched], tmp_path: Path
) -> None:
    write_loop_map(tmp_path / "loops.db")
    reader = MapReader(tmp_path / "loops.db")
    with MapWriter.open(reader.path) as writer:
        writer.save_grid(None)
    watched = open_scene(tmp_path / "loops.db")
    watched.change(layers={"grid": True})
    until(lambda: watched.handle("/grid") is not None and watched.handle("/grid").visible)
    floor, whole = watched.scene._painter._floor, floor_plan(reader, reader.poses())
    until(lambda: floor._drawn is not None and np.array_equal(floor._drawn[0].cells, whole.cells))
    watched.change(grid_as="probability")
    until(lambda: floor._drawn is not None and floor._drawn[3] == "probability")
    until(lambda: floor._drawn is not None and len(np.unique(floor._drawn[0].cells)) > 3)


def test_layers_are_switched_one_by_one_and_the_rest_stays(watched: Watched) -> None:
    before = watched.scene.state()
    state = watched.change(layers={"cloud": False, "truth": True, "frusta": True, "grid": True})
    assert (state.layers.graph, state.layers.cloud, state.layers.truth) == (True, False, True)
    assert state.layers.odometry == before.layers.odometry
    watched.wait()
    assert watched.handle("/grid").visible
    assert not watched.handle("/cloud/1").visible
    assert watched.handle("/paths/truth/0").visible
    assert watched.handle("/frusta/0").visible
    watched.change(layers={"graph": False})
    watched.wait()
    assert not watched.handle("/graph/nodes/0").visible
    assert not watched.handle("/graph/loop/0").visible
    assert not watched.handle("/newest").visible


def test_clouds_are_not_read_while_they_are_hidden(open_scene: Callable[[Path], Watched], room_map: Path) -> None:
    found = open_scene(room_map)
    found.change(layers={"cloud": False})
    until(lambda: found.scene._painter._framing)
    time.sleep(0.5)
    loaded = [i for i in range(1, 13) if found.handle(f"/cloud/{i}")]
    found.change(layers={"cloud": True})
    until(lambda: all(found.handle(f"/cloud/{i}") for i in range(1, 13)))
    assert loaded == [] or len(loaded) == 12


def test_colours_and_theme_change_without_sending_a_point(watched: Watched, sent: Sent) -> None:
    colours = watched.handle("/graph/nodes/0").batched_colors.copy()
    state = watched.change(colour="time", dark=False)
    assert (state.colour, state.dark) == ("time", False)
    until(lambda: not np.array_equal(watched.handle("/graph/nodes/0").batched_colors, colours))
    time.sleep(0.3)
    assert not {kind for kind, _ in sent.take()} & {"PointCloud", "update points", "update batched_positions"}


def test_clicks_select_and_are_told(watched: Watched) -> None:
    click(watched.api, "/graph/nodes/0", 6)
    assert watched.selections == [("node", (7,))]
    until(lambda: watched.handle("/selected/view"))
    assert watched.scene.state().selected_node == 7
    click(watched.api, "/graph/knots/loop/0", 0)
    assert watched.selections[1:] == [("link", (13, 1))]
    state = watched.scene.state()
    assert (state.selected_node, state.selected_link) == (None, [13, 1])


def test_a_selection_is_kept_until_another_or_null(watched: Watched) -> None:
    assert watched.change(selected_node=3).selected_node == 3
    assert watched.change(dark=False).selected_node == 3
    both = watched.change(selected_link=[13, 1], selected_node=13)
    assert (both.selected_node, both.selected_link) == (13, [13, 1])
    assert watched.change(selected_link=None).selected_node == 13
    assert watched.change(selected_node=None).selected_node is None


def test_when_poses_change_only_poses_are_sent(
    open_scene: Callable[[Path], Watched], room_map: Path, tmp_path: Path, sent: Sent
) -> None:
    path = Path(shutil.copy(room_map, tmp_path / "moving.db"))
    found = open_scene(path)
    until(lambda: found.handle("/cloud/12") and not found.scene._painter._clouds.missing)
    time.sleep(0.3)
    sent.take()
    moved = {i: true_pose(i) for i in range(1, NODES + 1)}
    for i in range(12, NODES + 1):
        moved[i][:3, 3] += 0.4
    with MapWriter.open(path) as writer:
        writer.save_poses(moved, None)
    found.scene.refresh()
    until(lambda: found.handle("/cloud/12").position[2] > 0.3)
    time.sleep(0.3)
    messages = sent.take()
    assert "PointCloud" not in {kind for kind, _ in messages}
    assert ("SetPosition", "/cloud/12") in messages
    assert ("update batched_positions", "/graph/nodes/0") in messages


def test_a_map_that_grows_is_followed_while_the_first_camera_stays_for_those_who_are_there(
    open_scene: Callable[[Path], Watched], tmp_path: Path
) -> None:
    path = write_room_map(tmp_path / "growing.db", 2, closed=False)
    found = open_scene(path)
    until(lambda: found.scene._painter._framing)
    framing = found.scene._painter._framing
    path.unlink()
    write_room_map(path, 14)
    found.view.touch()
    for _ in range(50):
        found.scene.refresh()
    until(lambda: len(found.handle("/graph/nodes/0").batched_positions) == 14 and found.handle("/cloud/12"))
    assert framing.distance > 7


def test_many_refreshes_at_once_are_few_drawings(watched: Watched, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[int] = []
    painter = watched.scene._painter
    original = painter.draw

    def counting(*args: Any) -> None:
        drawn.append(threading.get_ident())
        original(*args)

    monkeypatch.setattr(painter, "draw", counting)
    start = time.monotonic()
    for _ in range(200):
        watched.scene.refresh()
    assert time.monotonic() - start < 0.1
    until(lambda: drawn)
    time.sleep(0.5)
    assert len(drawn) < 5
    assert set(drawn) == {watched.scene._worker.ident}


def test_a_moment_of_the_past_hides_what_came_later_and_sends_no_cloud(watched: Watched, sent: Sent) -> None:
    watched.wait()
    sent.take()
    assert watched.change(at=14).at == 14
    watched.wait()
    assert len(watched.handle("/graph/nodes/0").batched_positions) == 14
    assert len(watched.handle("/graph/loop/0").points) > 0
    assert watched.handle("/graph/user/0") is None, "that loop came with node 20"
    assert [i for i in range(1, LAP + 1) if watched.handle(f"/cloud/{i}").visible] == list(range(1, LAP + 1))
    watched.change(at=5, colour="memory")
    watched.wait()
    assert [i for i in range(1, LAP + 1) if watched.handle(f"/cloud/{i}").visible] == [1, 2, 3, 4, 5]
    np.testing.assert_allclose(watched.handle("/newest").position, true_pose(5)[:3, 3], atol=1e-6)
    watched.scene.move(true_pose(9))
    assert watched.change(at=None).at is None
    watched.wait()
    assert len(watched.handle("/graph/nodes/0").batched_positions) == NODES
    assert watched.handle("/graph/user/0").visible
    kinds = {kind for kind, _ in sent.take()}
    assert "PointCloud" not in kinds
    assert not any("Camera" in kind and "Frustum" not in kind for kind in kinds), "nobody moves the camera"


def test_the_page_is_told_which_moment_is_shown_and_where_its_nodes_stand(room_map: Path) -> None:
    told: list[Scene] = []
    scene = MapScene(MapView(MapFile("room", "room", room_map)), lambda _kind, _ids: None, on_state=told.append)
    try:
        scene.change(SceneChange(at=14))
        until(lambda: any(one.placing == "then" for one in told))
        assert {one.at for one in told} == {14}
        scene.change(SceneChange(at=None))
        last = max(told, key=lambda one: one.revision)
        assert (last.at, last.placing) == (None, "now")
        assert len({one.revision for one in told}) == len(told)
    finally:
        scene.close()


def test_classes_of_links_sessions_and_a_trial_show_and_hide(watched: Watched) -> None:
    watched.change(hidden_links=["user", "refused"])
    watched.wait()
    assert watched.handle("/graph/user/0") is None
    assert len(watched.handle("/graph/loop/0").points) > 0
    watched.change(hidden_links=[], optimised={"ask": {"start": "map"}, "step": 99})
    watched.wait()
    assert len(watched.handle("/optimised/path/0").points) > 0
    watched.change(optimised=None, hidden_sessions=[0], colour="loops")
    watched.wait()
    assert watched.handle("/optimised/path/0") is None
    assert watched.handle("/graph/nodes/0") is None
    assert not watched.handle("/cloud/1").visible
    watched.change(hidden_sessions=[])
    watched.wait()
    assert len(watched.handle("/graph/nodes/0").batched_positions) == NODES


def test_a_live_pose_moves_the_newest_camera_between_nodes(watched: Watched) -> None:
    watched.scene.move(true_pose(3))
    until(lambda: np.allclose(watched.handle("/newest").position, true_pose(3)[:3, 3]))
    watched.scene.move(None)
    time.sleep(0.3)
    np.testing.assert_allclose(watched.handle("/newest").position, true_pose(3)[:3, 3])


def test_a_file_that_goes_leaves_the_view_as_it_was(
    open_scene: Callable[[Path], Watched], room_map: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = Path(shutil.copy(room_map, tmp_path / "going.db"))
    found = open_scene(path)
    until(lambda: found.handle("/graph/nodes/0"))
    path.unlink()
    found.scene.refresh()
    until(lambda: "not drawn anew" in caplog.text)
    assert len(found.handle("/graph/nodes/0").batched_positions) == NODES
    shutil.copy(room_map, path)
    found.change(selected_node=4)
    until(lambda: found.handle("/selected/rings/0"))


def test_closing_frees_the_port(room_map: Path) -> None:
    found = Watched(room_map)
    worker = found.scene._worker
    found.scene.close()
    assert worker is not None and not worker.is_alive()
    with pytest.raises(OSError):
        socket.create_connection(("127.0.0.1", found.scene.port), timeout=2)
    del found
    gc.collect()


def test_real_files_of_any_program_are_drawn(
    open_scene: Callable[[Path], Watched], shared_data: Path, tmp_path: Path
) -> None:
    files = sorted((shared_data / "rtabmap_db").glob("*.db"))
    assert files
    files += sorted((shared_data / "rtabmap_db" / "empty_schema").glob("*.db"))[:1]
    for number, source in enumerate(files):
        found = open_scene(Path(shutil.copy(source, tmp_path / f"{number}.db")))
        found.change(layers={"grid": True, "truth": True, "frusta": True}, colour="weight", selected_node=1)
        painter = found.scene._painter
        until(lambda p=painter: p._shown is not None and p._shown.state.colour == "weight")
        until(lambda p=painter: not p._clouds.missing)
        assert found.scene._worker.is_alive()


def test_viser_is_loaded_only_when_a_view_opens() -> None:
    code = "import sys, server.scene.scene; sys.exit('viser' in sys.modules)"
    root = Path(__file__).resolve().parents[4]
    assert subprocess.run([sys.executable, "-c", code], cwd=root, check=False, timeout=60).returncode == 0


def test_each_viewer_has_a_view_of_its_own_and_those_that_nobody_looks_at_stop(room_map: Path) -> None:
    view, scenes = MapView(MapFile("room", "room", room_map)), Scenes(Hub(), lambda *_: None)
    try:
        one, other = (scenes.get(view, name) for name in ("one", "other"))
        assert not one.is_started, "nothing is drawn before somebody looks"
        one.change(SceneChange(selected_node=3))
        assert scenes.get(view, "one") is one and other.state().selected_node is None
        names = ["one", "other", "third", "fourth", "fifth"]
        shown = [scenes.shown(view, name) for name in names]
        assert len({scene.port for scene in shown}) == len(names)
        assert [scene.is_started for scene in shown] == [False, True, True, True, True]
        assert scenes.shown(view, "one").state().selected_node == 3, "it comes back as it was"
        scenes.refresh("room")
        until(lambda: one._painter._viewer.scene.get_handle_by_name("/selected/label"))
    finally:
        scenes.close()
    assert not any(scene.is_started for scene in shown)
