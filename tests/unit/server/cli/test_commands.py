"""The command line: what it prints, and one line for everything that it refuses."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from slam.database import MapReader
from slam.params import specs
from slam.sensors import open_source
from slam.sensors.tum_writer import write_tum_folder
from tests.unit.server.loop_map import NODES, write_loop_map

TINY = "tour:fps=5,width=160,height=120,frames=6"


@pytest.fixture(scope="module")
def a_map(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("cli") / "loops.db"
    write_loop_map(path)
    return path


def slamdeck(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "server.cli", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=240)


def refusal(*arguments: object) -> str:
    """The one line that says why."""
    done = slamdeck(*arguments)
    assert done.returncode == 2, done.stdout + done.stderr
    lines = done.stderr.strip().splitlines()
    assert len(lines) == 1 and lines[0].startswith("error: "), done.stderr
    assert "Traceback" not in done.stderr and not done.stdout
    return lines[0]


def test_help_loads_nothing_heavy() -> None:
    heavy = {"gtsam", "open3d", "viser", "numba", "cv2", "fastapi", "sqlalchemy", "uvicorn"}
    code = f"import sys, server.cli.app; sys.exit(' '.join({heavy} & set(sys.modules)) or None)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_server_starts_without_what_draws_and_meshes() -> None:
    code = "import sys, server.app; sys.exit(' '.join({'open3d', 'viser'} & set(sys.modules)) or None)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_every_command_is_listed() -> None:
    text = slamdeck("--help").stdout
    assert all(name in text for name in ("demo", "run", "info", "reprocess", "try", "merge", "recover", "export"))


def test_without_a_command_the_help_is_shown() -> None:
    assert "Commands:" in slamdeck().stdout
    assert slamdeck("--version").stdout.startswith("slamdeck ")


def test_an_image_that_breaks_off_ends_the_run_and_the_map_stays(tmp_path: Path) -> None:
    tour, path = tmp_path / "tour", tmp_path / "m.db"
    write_tum_folder(open_source(TINY), tour)
    last = sorted((tour / "rgb").iterdir())[-1]
    last.write_bytes(last.read_bytes()[:100])
    said = refusal("run", tour, "--db", path, "--param", "Rtabmap/DetectionRate=0")
    assert last.name in said and "nodes mapped until then" in said and "--overwrite" in said
    assert MapReader(path).info().nodes >= 1


def test_info_of_a_map(a_map: Path) -> None:
    found = json.loads(slamdeck("info", a_map, "--json").stdout)
    assert (found["version"], found["nodes"]) == ("0.20.0", NODES)
    assert found["links"] == {"Neighbor": NODES - 1, "GlobalClosure": 2}
    assert found["parameters"] == {"Rtabmap/LoopThr": "0.2"} and found["bytes_by_kind"]["image"] > 0
    assert found["missing"] == [] and found["odometry_m"] > 0
    differing = json.loads(slamdeck("info", "--diff", a_map, "--json").stdout)["differences"]
    assert {one["name"] for one in differing} == set(found["parameters"])
    table = slamdeck("info", a_map).stdout
    assert "0.20.0" in table and "GlobalClosure" in table


def test_parameters_are_listed_and_searched() -> None:
    listed = json.loads(slamdeck("params", "--json").stdout)
    assert [entry["name"] for entry in listed] == [spec.name for spec in specs()]
    found = json.loads(slamdeck("params", "--json", "--search", "loopthr").stdout)
    assert [entry["name"] for entry in found] == ["Rtabmap/LoopThr", "RGBD/AggressiveLoopThr"]
    (line,) = (line for line in slamdeck("params", "--search", "timethr").stdout.splitlines() if "TimeThr" in line)
    assert next(spec.meaning for spec in specs() if spec.name == "Rtabmap/TimeThr") in line
    assert "lists them all" in refusal("params", "--search", "xyzzy")


def test_poses_are_exported(a_map: Path, tmp_path: Path) -> None:
    for format, first in (("tum", "# timestamp"), ("kitti", ""), ("g2o", "VERTEX_SE3:QUAT 1 ")):
        out = tmp_path / f"poses.{format}"
        shapes = ("--grid", tmp_path / "plan.pgm", "--cloud", tmp_path / "cloud.ply") if format == "g2o" else ()
        assert slamdeck("export", a_map, "--poses", out, "--format", format, *shapes).returncode == 0
        assert out.read_text().startswith(first) and len(out.read_text().splitlines()) >= NODES
    assert (tmp_path / "plan.pgm").read_bytes().startswith(b"P5") and (tmp_path / "plan.yaml").exists()
    assert (tmp_path / "cloud.ply").read_bytes().startswith(b"ply")


def test_tools_make_maps_and_replace_none_unasked(a_map: Path, tmp_path: Path) -> None:
    out = tmp_path / "new.db"
    made = json.loads(slamdeck("reprocess", a_map, "--db", out, "-p", "Rtabmap/LoopThr=0.3", "--json").stdout)
    assert made["nodes"] == NODES and made["db_mb"] > 0
    tried = json.loads(slamdeck("try", a_map, "-p", "Mem/STMSize=3", "--keep", tmp_path / "kept.db", "--json").stdout)
    assert tried["tried"]["nodes"] == NODES and tried["tried"]["stm_max"] == 3 and (tmp_path / "kept.db").exists()
    assert "--force" in refusal("recover", a_map, "--db", out)
    saved = json.loads(slamdeck("recover", a_map, "--db", out, "--force", "--json").stdout)
    assert saved["is_whole"] and saved["rows"]["Node"] == NODES
    assert "two or more" in refusal("merge", a_map, "--db", tmp_path / "all.db")


def test_a_run_prints_one_object_and_the_same_twice(tmp_path: Path) -> None:
    results = []
    for name in ("a.db", "b.db"):
        done = slamdeck("run", TINY, "--db", tmp_path / name, "--json", "--param", "Rtabmap/DetectionRate=0")
        assert done.returncode == 0, done.stderr
        results.append(json.loads(done.stdout))
    keys = [
        "frames",
        "nodes",
        "links",
        "loops",
        "ate_rmse_m",
        "lost_frames",
        "fps",
        "median_ms",
        "peak_rss_mb",
        "db_mb",
        "seed",
    ]
    assert list(results[0]) == keys
    same = ("frames", "nodes", "links", "loops", "ate_rmse_m", "lost_frames", "seed")
    assert [results[0][key] for key in same] == [results[1][key] for key in same]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.db", "b.db"]
    assert "exists already" in refusal("run", TINY, "--db", tmp_path / "a.db")
    more = slamdeck("run", TINY, "--db", tmp_path / "a.db", "--append", "--param", "Rtabmap/DetectionRate=0")
    assert more.returncode == 0, more.stderr
    info = json.loads(slamdeck("info", tmp_path / "a.db", "--json").stdout)
    assert (info["sessions"], info["nodes"]) == (2, 2 * results[0]["nodes"])
    assert [session["nodes"] for session in info["session_list"]] == [results[0]["nodes"]] * 2
    place = slamdeck("run", TINY, "--db", tmp_path / "a.db", "--localize", "--json")
    assert json.loads(place.stdout)["localization"]["localized_frames"] == results[0]["frames"], place.stderr
    assert "does not exist" in refusal("run", TINY, "--db", tmp_path / "c.db", "--localize")
    assert "not both" in refusal("run", TINY, "--db", tmp_path / "a.db", "--append", "--overwrite")
    assert slamdeck("run", TINY, "--db", tmp_path / "a.db", "--overwrite").returncode == 0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("info", "missing.db"), "missing.db"),
        (("serve", "missing.db"), "does not exist"),
        (("serve", "notes.db"), "notes.db"),
        (("serve", ".", "--host", "0.0.0.0", "--no-token"), "without a token"),
        (("serve", ".", "--token", "short"), "16 characters"),
        (("export", "notes.db", "--poses", "out.txt"), "notes.db"),
        (("run", "missing", "--db", "m.db"), "missing"),
        (("run", "tour:", "--db", "m.sqlite"), ".db"),
        (("run", "tour:", "--db", "nowhere/m.db"), "nowhere"),
        (("run", "tour:laps=many", "--db", "m.db"), "laps"),
        (("run", "tour:", "--db", "m.db", "--param", "Rtabmap/LoopThr=7"), "Rtabmap/LoopThr"),
        (("run", "tour:", "--db", "m.db", "--param", "Rtabmap/LoopTr=0.1"), "Rtabmap/LoopThr"),
        (("run", "tour:", "--db", "m.db", "--param", "Rtabmap/LoopThr"), "NAME=VALUE"),
        (("run", "tour:", "--db", "m.db", "--config", "missing.ini"), "missing.ini"),
        (("demo", "--db", "notes.db"), "exists already"),
        (("run", "tour:"), "--db"),
        (("run", "tour:", "--db", "m.db", "--nope"), "--nope"),
        (("run", "tour:", "--db", "m.db", "--speed", "fast"), "--speed"),
        (("ruin",), "ruin"),
        (("run", "tour:", "--db", "m.db", "--param", "Mem/ImageCompressionFormat=.bmp"), "'.jpg' or '.png'"),
        (("run", "tour:", "--db", "m.db", "--param", "Bayes/PredictionLC=0.1"), "two or more numbers"),
        (("run", "tour:", "--db", "m.db", "--param", "Vis/FeatureType=15"), "8 GFTT/ORB"),
        (("run", "tour:", "--db", "m.db", "--param", "Vis/FeatureType=100"), "ALIKED/ModelPath"),
        (("run", "tour:", "--db", "m.db", "--param", "Kp/IncrementalDictionary=false"), "Kp/DictionaryPath"),
    ],
)
def test_what_is_refused_is_one_line_that_says_what_would_be_right(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).resolve().parents[4]))
    (tmp_path / "notes.db").write_text("no database")
    assert said in refusal(*arguments)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.db"], "nothing was made or damaged"


def test_parameters_that_only_rtabmap_has_are_named_and_not_refused(tmp_path: Path) -> None:
    config = tmp_path / "rtabmap.ini"
    config.write_text("[Core]\nRtabmap\\DetectionRate=0\nSURF\\Upright=false\n")
    done = slamdeck("run", TINY, "--db", tmp_path / "m.db", "--config", config, "--param", "Odom/Holonomic=true")
    assert done.returncode == 0, done.stderr
    assert "SURF/Upright" in done.stderr and "Odom/Holonomic" in done.stderr


@pytest.mark.skipif(shutil.which("bash") is None or not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_disk_is_one_line(a_map: Path) -> None:
    assert "/dev" in refusal("export", a_map, "--poses", "/dev/full/poses.txt")
