"""Mapping the nodes of map files again, with other parameters, into a new file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Any

from slam.database import MapReader, MapWriter
from slam.errors import ParameterError
from slam.features.files import check_files
from slam.graph.graph import PoseGraph
from slam.odometry.stored import OwnOdometry, StoredOdometry
from slam.params import Params, Value
from slam.run import Tally, prepared
from slam.slam import Slam
from slam.tools.carry import Carried, carry
from slam.tools.ids import NewIds
from slam.tools.output import check_target, new_map
from slam.tools.parameters import changes_features, changes_words, taken
from slam.tools.replay import ImageUse, Replay
from slam.tools.settle import settle
from slam.types import Update

#: Called after each frame with what it did, the counts so far, and the number of frames in all.
OnFrame = Callable[[Update, Tally, int], None]


#: Each node of the inputs was worth keeping once; the files' own odometry is no source's external one.
EVERY_NODE: dict[str, Value] = {
    "Rtabmap/DetectionRate": 0.0,
    "RGBD/LinearUpdate": 0.0,
    "RGBD/AngularUpdate": 0.0,
    "Mem/BadSignaturesIgnored": False,
    "Mem/IncrementalMemory": True,
    "Odom/External": 0,
}


class Whose(StrEnum):
    """Where something comes from: the file, or made anew."""

    STORED = "stored"
    OWN = "own"


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Request:
    """What is wanted.

    Attributes:
        inputs: map files; each begins a session of its own.
        output: the map file to make.
        changes: parameters that differ from those of the first file.
        odometry: that of the files, or our own on their images.
        features: key points of the files or found anew; None finds them anew where a change asks for others.
        seed: of everything random.
        force: replace a file of the output's name.
        images: which of them are decoded, and kept.
        last_id: of the nodes that are replayed; None for all.
    """

    inputs: Sequence[Path]
    output: Path
    changes: Mapping[str, Value] = field(default_factory=dict)
    odometry: Whose = Whose.STORED
    features: Whose | None = None
    seed: int = 0
    force: bool = False
    images: ImageUse = field(default_factory=ImageUse)
    last_id: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Replayed:
    """What came of it: the summary, and where the nodes of the files have come to."""

    summary: dict[str, Any]
    ids: NewIds


def reprocess(request: Request, on_frame: OnFrame | None = None) -> dict[str, Any]:
    """Make the map; the summary of the run, with what was taken over. See ``replayed``."""
    return replayed(request, on_frame).summary


def replayed(request: Request, on_frame: OnFrame | None = None) -> Replayed:
    """Make the map.

    Every ordinary node becomes one again: ``Rtabmap/DetectionRate``, ``RGBD/LinearUpdate`` and ``AngularUpdate`` are 0
    unless they are among the changes. Loops are found anew; what people did is done again at the end.

    Raises:
        SlamError: an input can't be read, a parameter is refused, or the output can't be made.
    """
    check_target(request.output, request.inputs, force=request.force)
    readers = [MapReader(path) for path in request.inputs]
    params, refused = _params(readers[0], request)
    check_files(params)
    keeps = _keeps_features(readers[0], request)
    words = keeps and not changes_words(request.changes, taken(readers[0]).params)
    replay = Replay(readers, with_features=keeps, with_words=words, images=request.images, last_id=request.last_id)
    with new_map(request.output, request.inputs, force=request.force) as part:
        summary, ids = _mapped(replay, params, part, request, on_frame)
        sessions = _sessions(MapReader(part), ids, replay, len(readers))
        carried, unsettled = _by_hand(part, readers, ids, params, _next_session(readers[0], request))
        summary["db_mb"] = round(part.stat().st_size / 1e6, 3)
    summary |= {
        "inputs": [str(path) for path in request.inputs],
        "sessions": sessions,
        "replayed": len(replay.ids),
        "not_in_the_map": len(replay.ids) - len(ids),
        "features": str(Whose.STORED if replay.with_features else Whose.OWN),
        "odometry": str(request.odometry),
        "unreadable_images": list(replay.unreadable),
        "refused_parameters": refused,
        "by_hand": {"decisions": carried.decisions, "links": carried.links, "labels": carried.labels},
        "lost": carried.lost,
        "not_optimized": unsettled,
    }
    return Replayed(summary, ids)


def _params(reader: MapReader, request: Request) -> tuple[Params, dict[str, str]]:
    found = taken(reader)
    base = found.params.changed(EVERY_NODE)
    params = base.changed(request.changes)
    if not params.Mem.IncrementalMemory:
        raise ParameterError("Mem/IncrementalMemory false would make no map: reprocess makes a new one")
    return params, {name: text for name, text in found.refused.items() if name not in request.changes}


def _keeps_features(reader: MapReader, request: Request) -> bool:
    others = changes_features(request.changes, taken(reader).params)
    if request.features is Whose.STORED and others:
        raise ParameterError(f"{others[0]} asks for other key points than those that are stored: find them anew")
    return not others if request.features is None else request.features is Whose.STORED


def _mapped(
    replay: Replay, params: Params, part: Path, request: Request, on_frame: OnFrame | None
) -> tuple[dict[str, Any], NewIds]:
    own = request.odometry is Whose.OWN
    writer = MapWriter.create(part, params, seed=request.seed, source=replay.name)
    with writer:
        tracker = OwnOdometry(params) if own else StoredOdometry()
        slam = Slam(params, writer, seed=request.seed, source=replay.name, tracker=tracker)
        tally, ids, total = Tally(), NewIds(), len(replay)
        for frame in prepared(replay, slam):
            update = slam.process(frame)
            tally.add(update)
            T_odom_base, old = update.odometry.T_odom_base, replay.ids[frame.index]
            if update.node is not None:
                ids.became(old, update.node.id, update.node.T_odom_base)
            elif T_odom_base is not None:
                ids.joined(old, T_odom_base)
            if on_frame is not None:
                on_frame(update, tally, total)
        slam.close()
    return tally.summary(slam, seed=request.seed, path=part), ids


def _sessions(reader: MapReader, ids: NewIds, replay: Replay, files: int) -> list[list[int]]:
    """The sessions of the new map that each file became."""
    table = reader.nodes()
    map_id_of = dict(zip(table.ids.tolist(), table.map_ids.tolist(), strict=True))
    found: list[set[int]] = [set() for _ in range(files)]
    for old in replay.ids:
        new_id = ids.get(old.file, old.node_id)
        if new_id is not None:
            found[old.file].add(map_id_of[new_id])
    return [sorted(one) for one in found]


def _next_session(reader: MapReader, request: Request) -> dict[str, Value]:
    """What a session that goes on from the new map starts with in place of what holds for a replay alone."""
    wanted = taken(reader).params.changed(request.changes)
    return {name: wanted.get(name) for name in EVERY_NODE if name != "Mem/IncrementalMemory"}


def _by_hand(
    part: Path, readers: Sequence[MapReader], ids: NewIds, params: Params, next_session: Mapping[str, Value]
) -> tuple[Carried, list[str]]:
    with MapWriter.open(part) as writer:
        writer.change_parameters(next_session)
        graph = PoseGraph.from_reader(MapReader(part))
        carried = carry(writer, graph, readers, ids)
        return carried, settle(writer, graph, params) if carried.decisions else []
