"""Links by hand and in bulk on a map of the rendered tour, whose true poses are known."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from slam.database import MapReader, MapWriter
from slam.edit.detect import close_pairs, detect_more
from slam.edit.job import Job, JobStep
from slam.edit.links import LinkEditor
from slam.edit.refine import refine_links
from slam.edit.wishes import Detection, LinkEdit, Matching, PickedPair, Refinement
from slam.effect import Effect
from slam.errors import DecisionError
from slam.geometry import Pose, between, inverse, rotation_angle, se3_exp, transform, translation_norm
from slam.graph import PoseGraph
from slam.params import Params
from slam.review import Review
from slam.types import LinkType
from tests.graphs import stacked
from tests.tours import EVERY, mapped

#: Off by a hand's breadth and a few degrees.
WRONG = se3_exp(np.array([0.06, -0.05, 0.04, 0.02, -0.03, 0.04]))


class Opened(NamedTuple):
    review: Review
    editor: LinkEditor
    reader: MapReader
    writer: MapWriter


@pytest.fixture
def opened(tmp_path: Path) -> Iterator[Opened]:
    path = shutil.copy(mapped(0).path, tmp_path / "tour.db")
    with MapWriter.open(path) as writer:
        reader = MapReader(path)
        review = Review(PoseGraph.from_reader(reader), writer, reader, EVERY)
        yield Opened(review, LinkEditor(review, reader), reader, writer)


def loops(graph: PoseGraph) -> list[tuple[int, int]]:
    return sorted(pair for pair, link in graph.links.items() if link.type.is_loop)


def truth(reader: MapReader, from_id: int, to_id: int) -> Pose:
    table = reader.nodes()
    row = {int(node_id): k for k, node_id in enumerate(table.ids)}
    return between(table.T_world[row[from_id]], table.T_world[row[to_id]])


def off(T: Pose | None, true: Pose) -> tuple[float, float]:
    """Metres and degrees."""
    assert T is not None
    error = inverse(true) @ T
    return translation_norm(error), float(np.degrees(rotation_angle(error)))


def without_loops(opened: Opened) -> list[tuple[int, int]]:
    """Rejects all loops; their pairs."""
    gone = loops(opened.review.graph)
    opened.review.decide("reject", gone, "")
    return gone


def run(job: Job) -> tuple[Effect | None, list[JobStep]]:
    steps: list[JobStep] = []
    while True:
        try:
            steps.append(next(job))
        except StopIteration as end:
            return end.value, steps


@pytest.mark.parametrize(("method", "guess"), [("visual", "none"), ("visual", "graph"), ("both", "none")])
def test_a_link_that_was_removed_is_found_again_by_hand(opened: Opened, method: str, guess: str) -> None:
    a, b = without_loops(opened)[-1]
    edit = LinkEdit(action="add", from_id=a, to_id=b, how=Matching(method, guess), author="ann")  # type: ignore[arg-type]
    poses = opened.review.graph.poses
    seen = opened.editor.preview(edit)
    assert seen.effect is not None and seen.effect.preview
    assert opened.review.graph.poses is poses, "a preview changes nothing"
    done = opened.editor.carry_out(edit)
    assert done.link is not None and done.effect is not None and done.registration is not None
    assert (done.link.from_id, done.link.to_id) == (max(a, b), min(a, b)), "from the newer to the older"
    assert done.link.type is LinkType.USER_CLOSURE
    assert off(done.link.T_from_to, truth(opened.reader, done.link.from_id, done.link.to_id)) < (0.03, 1.0)
    assert seen.effect.chi2_after == pytest.approx(done.effect.chi2_after), "the preview said what it would do"
    assert (a, b) in {link.pair for link in opened.reader.links()}
    with pytest.raises(DecisionError, match="already"):
        opened.editor.carry_out(edit)
    opened.review.undo()
    assert np.array_equal(stacked(opened.review.graph.poses), stacked(poses))
    assert (a, b) not in {link.pair for link in opened.reader.links()}


def test_places_that_do_not_look_alike_are_refused_with_the_test(opened: Opened) -> None:
    edit = LinkEdit(action="add", from_id=20, to_id=60, how=Matching("visual", "none"))
    seen = opened.editor.preview(edit)
    assert seen.link is None and seen.effect is None
    assert seen.refusal is not None and seen.refusal.test == "Vis/MinInliers"
    with pytest.raises(DecisionError, match="Vis/MinInliers"):
        opened.editor.carry_out(edit)
    assert not opened.reader.journal()


@pytest.mark.parametrize("method", ["visual", "icp"])
def test_a_wrong_link_is_refined_back_and_reset(opened: Opened, method: str) -> None:
    a, b = loops(opened.review.graph)[-1]
    good = opened.review.graph.links[a, b]
    assert good.T_from_to is not None
    ids, sigmas = {"from_id": good.from_id, "to_id": good.to_id}, np.full(6, 0.05)
    opened.editor.carry_out(LinkEdit(action="edit", T_from_to=good.T_from_to @ WRONG, sigmas=sigmas, force=True, **ids))
    params = EVERY.changed({"Icp/MaxCorrespondenceDistance": 0.2})
    opened.review.params = params
    how = Matching(method)  # type: ignore[arg-type]
    refined = opened.editor.carry_out(LinkEdit(action="refine", how=how, **ids)).link
    assert refined is not None and refined.type is good.type
    assert off(refined.T_from_to, truth(opened.reader, refined.from_id, refined.to_id)) < (0.04, 1.5)
    opened.editor.carry_out(LinkEdit(action="reset", force=True, **ids))
    now = opened.review.graph.links[a, b]
    assert now.T_from_to is not None and np.allclose(now.T_from_to, good.T_from_to)
    assert [entry.action for entry in opened.reader.journal()] == ["edit", "refine", "reset"]
    for _ in range(3):
        opened.review.undo()
    with pytest.raises(DecisionError, match="as it was made"):
        opened.editor.preview(LinkEdit(action="reset", **ids))


def test_the_graph_objects_to_a_false_link_unless_it_is_forced(opened: Opened) -> None:
    a, b = 30, 5
    edit = LinkEdit(action="edit", from_id=a, to_id=b, T_from_to=np.eye(4), sigmas=np.full(6, 0.01))
    seen = opened.editor.preview(edit)
    assert seen.refusal is not None and seen.refusal.test == "RGBD/OptimizeMaxError"
    assert seen.effect is not None and seen.effect.moved > 0, "it says what would come of it all the same"
    with pytest.raises(DecisionError, match="OptimizeMaxError"):
        opened.editor.carry_out(edit)
    done = opened.editor.carry_out(replace(edit, force=True))
    assert done.link is not None and done.link.type is LinkType.USER_CLOSURE


def test_an_axis_of_sigma_nothing_is_not_known(opened: Opened) -> None:
    sigmas = np.array([0.0, 0.1, 0.1, 0.02, 0.02, 0.0])
    true = truth(opened.reader, 3, 1)
    edit = LinkEdit(action="edit", from_id=3, to_id=1, T_from_to=true, sigmas=sigmas, force=True)
    done = opened.editor.carry_out(edit)
    assert done.link is not None
    variances = 1.0 / np.diagonal(done.link.information)
    assert variances[[0, 5]] == pytest.approx(9999.0)
    assert variances[1] == pytest.approx(0.01)


def test_picked_points_make_a_link(opened: Opened) -> None:
    old, new = max(loops(opened.review.graph))
    without_loops(opened)
    true = truth(opened.reader, new, old)
    camera, depth = opened.reader.camera(new), opened.reader.depth_m(new)
    other = opened.reader.depth_m(old)
    pairs = []
    for y in range(30, camera.height - 30, 30):
        for x in range(30, camera.width - 30, 30):
            scale = depth.shape[1] / camera.width
            z = float(depth[int((y + 0.5) * scale), int((x + 0.5) * scale)])
            if z <= 0:
                continue
            base = transform(camera.T_base_cam, camera.unproject(np.array([[x, y]]), np.array([z])))
            cam = transform(inverse(camera.T_base_cam), transform(inverse(true), base))
            u, v = camera.project(cam)[0]
            inside = 5 <= u < camera.width - 5 and 5 <= v < camera.height - 5
            if inside and abs(float(other[int((v + 0.5) * scale), int((u + 0.5) * scale)]) - cam[0, 2]) < 0.02:
                pairs.append(PickedPair((x, y), (round(float(u)), round(float(v)))))
    assert len(pairs) >= 4
    done = opened.editor.carry_out(LinkEdit(action="points", from_id=new, to_id=old, pairs=pairs))
    assert done.link is not None and done.residuals_m is not None
    assert len(done.residuals_m) == len(pairs)
    assert off(done.link.T_from_to, true) < (0.05, 1.5)


def test_detect_more_finds_loops_that_were_removed_and_one_undo_takes_them_back(opened: Opened) -> None:
    gone = without_loops(opened)
    poses, before = opened.review.graph.poses, len(opened.reader.candidates())
    wanted = Detection(radius_m=1.0, angle_deg=40.0, iterations=3, min_graph_distance=10)
    effect, steps = run(detect_more(opened.review, opened.editor.views, wanted, "ann"))
    assert effect is not None
    found = loops(opened.review.graph)
    assert len(found) >= min(5, len(gone) // 2)
    for old, new in found:
        assert new - old >= 10
        link = opened.review.graph.links[old, new]
        assert off(link.T_from_to, truth(opened.reader, link.from_id, link.to_id)) < (0.05, 2.0)
    shares = [step.share for step in steps]
    assert shares == sorted(shares) and shares[-1] == 1.0
    looked_at = opened.reader.candidates()[before:]
    assert {(c.candidate.to_id, c.candidate.from_id) for c in looked_at if c.candidate.refusal is None} == set(found)
    assert all(c.candidate.refusal.text for c in looked_at if c.candidate.refusal is not None)
    opened.review.undo()
    assert not loops(opened.review.graph)
    assert np.array_equal(stacked(opened.review.graph.poses), stacked(poses)), "to the last bit"


def test_a_job_that_is_stopped_has_changed_nothing(opened: Opened) -> None:
    without_loops(opened)
    journal, looked_at = len(opened.reader.journal()), len(opened.reader.candidates())
    links, poses = dict(opened.review.graph.links), opened.review.graph.poses
    job = detect_more(opened.review, opened.editor.views, Detection(radius_m=1.0, angle_deg=40.0))
    for _ in range(4):
        next(job)
    job.close()
    assert opened.review.graph.links == links and opened.review.graph.poses is poses
    assert (len(opened.reader.journal()), len(opened.reader.candidates())) == (journal, looked_at)


def test_pairs_that_are_looked_at_are_as_far_as_was_asked(opened: Opened) -> None:
    without_loops(opened)
    graph = opened.review.graph
    pairs = list(close_pairs(graph, Detection(radius_m=0.9, min_radius_m=0.1, angle_deg=25, min_graph_distance=20)))
    assert pairs
    for new, old in pairs:
        distance = float(np.linalg.norm(graph.poses[new][:3, 3] - graph.poses[old][:3, 3]))
        assert new - old >= 20 and 0.1 <= distance <= 0.9
        assert graph.poses[new][:3, 0] @ graph.poses[old][:3, 0] >= np.cos(np.radians(25.001))
    assert not list(close_pairs(graph, Detection(radius_m=5, angle_deg=180, intra=False)))
    with pytest.raises(DecisionError, match="no pair"):
        run(detect_more(opened.review, opened.editor.views, Detection(intra=False, inter=False)))


def test_links_are_refined_in_bulk_as_one_batch(opened: Opened) -> None:
    wanted = Refinement(types=(LinkType.NEIGHBOR,), first=10, last=24)
    before = dict(opened.review.graph.links)
    effect, steps = run(refine_links(opened.review, opened.editor.views, wanted, "ann"))
    assert effect is not None and len(effect.entries) >= 10
    assert len({entry.batch for entry in effect.entries}) == 1
    changed = {pair for pair, link in opened.review.graph.links.items() if link is not before[pair]}
    assert all(low >= 10 and high <= 24 for low, high in changed)
    assert steps[-1].text.endswith("14 links refined")
    for pair in changed:
        link = opened.review.graph.links[pair]
        assert off(link.T_from_to, truth(opened.reader, link.from_id, link.to_id)) < (0.05, 2.0)
    opened.review.undo()
    now = opened.review.graph.links
    assert all(np.array_equal(now[pair].T_from_to, before[pair].T_from_to) for pair in changed)  # type: ignore[arg-type]


def test_covariances_alone_leave_the_transforms(opened: Opened) -> None:
    pair = loops(opened.review.graph)[0]
    made = opened.review.graph.links[pair]
    vague = LinkEdit(
        action="edit", from_id=made.from_id, to_id=made.to_id, T_from_to=made.T_from_to, sigmas=np.full(6, 0.5)
    )
    opened.editor.carry_out(vague)
    before = opened.review.graph.links[pair]
    wanted = Refinement(types=(before.type,), first=pair[0], last=pair[1], covariance_only=True)
    effect, _ = run(refine_links(opened.review, opened.editor.views, wanted))
    assert effect is not None
    after = opened.review.graph.links[pair]
    assert after.T_from_to is before.T_from_to
    assert np.allclose(after.information, made.information, rtol=0.1), "what the registration said at first"


def test_nothing_to_refine_is_said(opened: Opened) -> None:
    with pytest.raises(DecisionError, match="nothing would be refined"):
        run(refine_links(opened.review, opened.editor.views, Refinement(first=10**6)))


def test_views_follow_the_parameters(opened: Opened) -> None:
    views = opened.editor.views
    first = views.of(5, EVERY, cloud=False)
    assert views.of(5, EVERY, cloud=False) is first
    other: Params = EVERY.changed({"Vis/CorType": 1})
    assert views.of(5, other, cloud=False).images is not None
    assert views.of(5, EVERY, cloud=True).scan is not None
