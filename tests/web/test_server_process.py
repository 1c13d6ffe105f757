"""The real program in processes of its own: started, used, ended, killed."""

from __future__ import annotations

import json
import os
import shutil
import signal
import sqlite3
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from slam.database import MapReader
from tests.unit.server.loop_map import write_loop_map
from tests.web.served import SMALL_TOUR, Served, command

#: The engine compiles itself when it first runs on a machine, which a busy one takes long for.
pytestmark = pytest.mark.timeout(600)

SECONDS = 240


def api(server: Served, method: str, path: str, body: Any = None) -> Any:
    """An answer of the API, by the token of the printed link."""
    request = urllib.request.Request(
        server.base.rstrip("/") + path,
        method=method,
        data=None if body is None else json.dumps(body).encode(),
        headers={"Authorization": f"Bearer {server.url.split('token=')[1]}", "Content-Type": "application/json"},
    )
    with urllib.request.urlopen(request, timeout=60) as answer:
        return json.loads(answer.read())


def until(holds: Callable[[], Any], what: str) -> Any:
    """Waits until something holds; its value."""
    end = time.monotonic() + SECONDS
    while time.monotonic() < end:
        found = holds()
        if found:
            return found
        time.sleep(0.1)
    raise AssertionError(f"not within {SECONDS} s: {what}")


def engine_pid(server: Served) -> int:
    """The process that the server has started for its engine."""
    if shutil.which("pgrep") is None:
        pytest.skip("needs pgrep to find the engine's process")
    [nursery] = children(server.process.pid, "forkserver")
    [engine] = children(nursery)
    return engine


def children(pid: int, command_line: str = "") -> list[int]:
    """The processes that one has started, of those whose command line contains a text."""
    pattern = ["pgrep", "--parent", str(pid), "--full", command_line]
    found = subprocess.run(pattern, capture_output=True, text=True, check=False).stdout.split()
    return [int(number) for number in found]


def assert_sound(path: Path, nodes: int) -> None:
    """The map opens for reading and for writing, is whole, and ends as one plain file."""
    reader = MapReader(path)
    info = reader.info()
    assert info.nodes >= nodes
    assert len(reader.poses()) == info.nodes, "the optimised poses are always stored"
    for node_id in reader.node_ids().tolist():
        assert reader.image_bgr(node_id).size and len(reader.features(node_id)[0])
    from slam.database import MapWriter

    MapWriter.open(path).close()
    assert sorted(part.name for part in path.parent.glob(path.name + "*")) == [path.name]
    with sqlite3.connect(path) as connection:
        assert connection.execute("pragma integrity_check").fetchone() == ("ok",)
        assert connection.execute("pragma journal_mode").fetchone() == ("delete",)


@pytest.fixture
def mapping(tmp_path: Path) -> Any:
    """A server that maps, with some nodes in the file."""
    path = tmp_path / "flat.db"
    server = Served("run", SMALL_TOUR, "--db", str(path), "--serve", "--port", "0", "--speed", "2")
    until(lambda: api(server, "GET", "/api/session")["nodes"] >= 4, "four nodes")
    yield server, path
    if server.process.poll() is None:
        server.process.kill()
    server.process.wait(30)


def test_serve_use_and_end_in_order(tmp_path: Path) -> None:
    write_loop_map(tmp_path / "loops.db")
    server = Served("serve", str(tmp_path), "--port", "0")
    assert api(server, "GET", "/api/maps")["maps"][0]["id"] == "loops"
    with pytest.raises(urllib.error.HTTPError) as refused:
        urllib.request.urlopen(server.base + "api/maps", timeout=20)
    assert refused.value.code == 401
    refused.value.close()
    api(server, "POST", "/api/maps/loops/decisions", {"action": "reject", "from": 11, "to": 1})
    server.process.send_signal(signal.SIGTERM)
    assert server.process.wait(40) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["loops.db"]
    assert MapReader(tmp_path / "loops.db").journal()[0].action == "reject"


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_in_mid_run_closes_the_map(mapping: tuple[Served, Path], number: signal.Signals) -> None:
    server, path = mapping
    server.process.send_signal(number)
    assert server.process.wait(60) == 0
    assert [part.name for part in path.parent.iterdir()] == [path.name]
    assert MapReader(path).info().clean
    assert_sound(path, 4)


def test_a_killed_engine_is_said_and_the_map_is_sound(mapping: tuple[Served, Path]) -> None:
    server, path = mapping
    nodes = api(server, "GET", "/api/session")["nodes"]
    os.kill(engine_pid(server), signal.SIGKILL)
    state = until(lambda: _state_if(server, "failed"), "the state failed")
    assert "SIGKILL" in state["message"]
    assert api(server, "GET", "/api/maps/flat")["nodes"] >= nodes
    assert api(server, "GET", "/api/maps/flat/graph")["nodes"]["id"]
    decided = api(server, "GET", "/api/maps/flat/loops")
    assert decided["counts"] is not None
    server.process.terminate()
    assert server.process.wait(40) == 0
    assert_sound(path, nodes)


def test_a_killed_server_leaves_no_engine_behind_and_a_sound_map(mapping: tuple[Served, Path]) -> None:
    server, path = mapping
    nodes = api(server, "GET", "/api/session")["nodes"]
    engine = engine_pid(server)
    server.process.kill()
    server.process.wait(30)
    until(lambda: not Path(f"/proc/{engine}/cmdline").exists() or not _command_line(engine), "the end of the engine")
    until(lambda: not path.with_name(path.name + "-wal").exists(), "one plain file")
    assert MapReader(path).info().clean, "the engine closed the map in order"
    assert_sound(path, nodes)


def test_a_busy_port_is_one_line(tmp_path: Path) -> None:
    server = Served("serve", str(tmp_path), "--port", "0")
    port = server.base.rstrip("/").rsplit(":", 1)[1]
    done = subprocess.run(
        command("serve", str(tmp_path), "--port", port), capture_output=True, text=True, check=False, timeout=60
    )
    server.close()
    assert done.returncode == 2
    assert done.stderr.startswith("error: ") and len(done.stderr.splitlines()) == 1
    assert port in done.stderr and "--port" in done.stderr


def test_a_map_in_use_by_another_writer_is_one_line(mapping: tuple[Served, Path]) -> None:
    _, path = mapping
    done = subprocess.run(
        command("run", SMALL_TOUR, "--db", str(path), "--overwrite"),
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert done.returncode == 2
    assert "is being written by" in done.stderr and len(done.stderr.strip().splitlines()) == 1


def _state_if(server: Served, wanted: str) -> Any:
    state = api(server, "GET", "/api/session")
    return state if state["state"] == wanted else None


def _command_line(pid: int) -> bytes:
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return b""
