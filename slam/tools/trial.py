"""Trying parameters on a map: its nodes replayed as they were and with the changes, and both outcomes compared."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

from slam.database import MapReader
from slam.graph.graph import Pair
from slam.graph.shift import Shift
from slam.odometry.stored import StoredOdometry
from slam.params import Params, Value
from slam.run import Tally
from slam.saving import save
from slam.slam import Slam
from slam.tools.outcome import Outcome, outcome
from slam.tools.parameters import changes_features
from slam.tools.replay import ImageUse, Replay
from slam.tools.reprocess import EVERY_NODE, Request, replayed
from slam.tools.wanted import Wanted, check
from slam.types import Update

#: Called with the share that is done, 0 to 1, and what is being done.
OnShare = Callable[[float, str], None]

#: Nodes to warm up with.
_WARM_UP = 6


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """A map, its replay as it was, and its replay with other parameters; loops by both ids, smaller first.

    Attributes:
        original: the map as it is.
        baseline: replayed with its own parameters: what the trial is compared with.
        tried: replayed with the changes.
        old_ids: nodes of the tried map -> nodes of the original.
        came: loops that only the trial has, with why the baseline does not have them.
        gone: loops that only the baseline has, with why the trial does not.
        unlike: loops that either the original or the baseline has: none where the replay repeats the run.
        drift_m: the farthest that a node of the baseline is from where the original has it.
        shift: how the trial's poses differ from the baseline's.
        images: why images were decoded for the trial; empty where the stored key points were enough.
    """

    original: Outcome
    baseline: Outcome
    tried: Outcome
    old_ids: Mapping[int, int]
    came: Mapping[Pair, str]
    gone: Mapping[Pair, str]
    unlike: int
    drift_m: float
    shift: Shift
    images: str


def carry_out(wanted: Wanted, baseline: Path, output: Path, on_share: OnShare) -> Comparison:
    """Replay the map as it was, unless ``baseline`` is there already, and with the changes into ``output``; compare.

    Neither file gets images; ``slam.tools.kept`` adds them. What is not stored is decoded: images where a change asks
    for other key points, depth where local grids or clouds are to be made anew.

    Raises:
        SlamError: what ``check`` refuses, or the map can't be replayed.
    """
    before, after = check(wanted)
    reader = MapReader(wanted.path)
    why, images = _images(before, after)
    # Each node was worth keeping once, whatever is in force for those to come.
    base = {name: value for name, value in wanted.base.items() if name not in EVERY_NODE}
    _warm_up(Replay([reader], images=images), after)
    # A map that is being made goes on growing: all sides are of the nodes that it has now.
    now = reader.node_ids().tolist()
    request = Request(
        inputs=[wanted.path], output=output, seed=_seed(reader), force=True, images=images, last_id=max(now, default=0)
    )
    # The baseline is there once it says whose its nodes are.
    known, begin = baseline.with_suffix(".json"), 0.0
    if not known.exists():
        begin = 0.5
        as_it_was = replace(request, output=baseline, changes=base, images=_images_of(before))
        save(known, json.dumps(_replayed(as_it_was, 0.0, begin, "as it was", on_share)))
    ids = {int(new_id): int(old_id) for new_id, old_id in json.loads(known.read_text("utf-8")).items()}
    request = replace(request, changes={**base, **wanted.changes})
    old_ids = _replayed(request, begin, 1.0, "with the changes", on_share)
    was = outcome(reader, {i: i for i in now})
    repeated, tried = outcome(MapReader(baseline), ids), outcome(MapReader(output), old_ids)
    return _compared(was, repeated, tried, old_ids, why)


def _warm_up(replay: Replay, params: Params) -> None:
    """Go twice through the first nodes, in RAM: what is compiled or loaded at its first use must not count as time.

    Otherwise the first updates of whichever replay comes first would be slow, and exceed ``Rtabmap/TimeThr``.
    """
    frames = list(islice(replay, _WARM_UP))
    small: dict[str, Value] = {"Mem/STMSize": 2, "Rtabmap/MemoryThr": 3, "Rtabmap/TimeThr": 0.0, "Rtabmap/LoopThr": 0.0}
    slam = Slam(params.changed({**EVERY_NODE, **small}), tracker=StoredOdometry())
    for frame in [*frames, *frames]:
        slam.process(frame)


def _seed(reader: MapReader) -> int:
    return next((one.seed for one in reversed(reader.sessions()) if one.seed is not None), 0)


def _images(before: Params, after: Params) -> tuple[str, ImageUse]:
    """Why images have to be decoded, and which."""
    lean, changes = _images_of(after), dict(after.items())
    if named := changes_features(changes, before):
        return f"{named[0]} asks for other key points", replace(lean, color=True, depth=True)
    if after.Vis.CorType == 1:
        return "Vis/CorType 1 follows points through images", replace(lean, color=True, depth=True)
    grids = [name for name in changes if name.startswith("Grid/") and after.get(name) != before.get(name)]
    if grids and after.RGBD.CreateOccupancyGrid:
        return f"{grids[0]} makes other local grids of the depth images", replace(lean, depth=True)
    return "", lean


def _images_of(params: Params) -> ImageUse:
    """What is needed of images when nothing asks for more: what is not stored."""
    return ImageUse(
        color=params.Vis.CorType == 1,
        depth=params.Vis.CorType == 1,
        for_clouds=params.Reg.Strategy > 0,
        for_grids=params.RGBD.CreateOccupancyGrid,
        kept=False,
    )


def _replayed(request: Request, begin: float, end: float, how: str, on_share: OnShare) -> dict[int, int]:
    """Replay into the request's output; its nodes -> those of the original."""

    def told(update: Update, tally: Tally, frames: int) -> None:
        del update
        share = begin + (end - begin) * tally.frames / max(frames, 1)
        on_share(share, f"replaying {how}: node {tally.frames} of {frames}")

    return replayed(request, told).ids.old_ids(0)


def _compared(
    original: Outcome, baseline: Outcome, tried: Outcome, old_ids: Mapping[int, int], images: str
) -> Comparison:
    return Comparison(
        original=original,
        baseline=baseline,
        tried=tried,
        old_ids=old_ids,
        came=_only(tried, baseline),
        gone=_only(baseline, tried),
        unlike=len(original.loops.keys() ^ baseline.loops.keys()),
        drift_m=Shift.between(original.poses, baseline.poses).max_m,
        shift=Shift.between(baseline.poses, tried.poses),
        images=images,
    )


def _only(one: Outcome, other: Outcome) -> dict[Pair, str]:
    """Loops that the other does not have, with why, the newest node first to last."""
    pairs = sorted(one.loops.keys() - other.loops.keys(), key=lambda pair: pair[::-1])
    return {pair: other.refusals.get(pair, "") for pair in pairs}
