"""``slamdeck detect``, ``refine``, ``optimize`` and ``turn`` write into the file, with the journal."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from slam.database import MapReader, MapWriter
from slam.graph import PoseGraph
from slam.review import Review
from tests.tours import EVERY, mapped


@pytest.fixture
def tour(tmp_path: Path) -> Path:
    """The rendered tour without its loops."""
    path = Path(shutil.copy(mapped(0).path, tmp_path / "tour.db"))
    with MapWriter.open(path) as writer:
        reader = MapReader(path)
        review = Review(PoseGraph.from_reader(reader), writer, reader, EVERY)
        review.decide("reject", [pair for pair, link in review.graph.links.items() if link.type.is_loop])
    return path


def slamdeck(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "server.cli", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=240)


def test_loops_are_detected_and_links_refined_in_the_file(tour: Path) -> None:
    done = slamdeck("detect", tour, "--angle", 40, "--iterations", 2, "--author", "ann", "--json", "-v")
    assert done.returncode == 0, done.stderr
    told, journal = json.loads(done.stdout), MapReader(tour).journal()
    added = [entry for entry in journal if entry.action == "add"]
    assert len(added) == told["changed"] > 1
    assert {(entry.author, entry.batch) for entry in added} == {("ann", told["batch"])}
    assert "agree" in done.stderr, "a line for every pair"
    assert sorted(path.name for path in tour.parent.iterdir()) == ["tour.db"], "one plain file again"

    done = slamdeck("refine", tour, "--type", "UserClosure")
    assert done.returncode == 0, done.stderr
    assert "links refined" in done.stdout and "chi2" in done.stdout and "trajectory error" in done.stdout
    assert MapReader(tour).journal()[-1].action == "refine"


def test_poses_are_optimised_on_trial_kept_and_turned(tour: Path) -> None:
    ask = ("optimize", tour, "--ignore", "Gravity", "--root", 3, "--solver", "gn")
    before = tour.read_bytes()
    tried = slamdeck(*ask, "--json")
    assert tried.returncode == 0, tried.stderr
    assert json.loads(tried.stdout)["root"] == 3 and tour.read_bytes() == before
    kept = slamdeck(*ask, "--keep")
    assert kept.returncode == 0, kept.stderr
    assert "kept: root 3; without Gravity; Gauss-Newton; from odometry" in kept.stdout
    turned = slamdeck("turn", tour, "--to", "truth", "--author", "ann", "--json")
    assert turned.returncode == 0, turned.stderr
    assert json.loads(turned.stdout)["moved"] > 0
    assert [(one.action, one.author) for one in MapReader(tour).journal()[-2:]] == [
        ("optimise", "slamdeck optimize"),
        ("turn", "ann"),
    ]


def test_what_makes_no_sense_is_refused_in_one_line(tour: Path) -> None:
    before = len(MapReader(tour).journal())
    for arguments, why in (
        (("refine", tour, "--type", "Nearby"), "no kind of link"),
        (("refine", tour, "--first", 5000), "nothing would be refined"),
        (("detect", tour, "--no-intra", "--no-inter"), "no pair"),
        (("detect", tour.with_name("none.db")), "none.db"),
        (("optimize", tour, "--ignore", "Nearby"), "no kind of link"),
        (("turn", tour), "--yaw"),
    ):
        done = slamdeck(*arguments)
        assert done.returncode == 2 and why in done.stderr and len(done.stderr.strip().splitlines()) == 1
    assert len(MapReader(tour).journal()) == before
