"""Optimised poses that a map file lacks, computed for whoever looks at it; the file stays as it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from slam.errors import OptimizationError
from slam.geometry import Pose
from slam.graph import PoseGraph
from slam.graph.completion import completed
from slam.graph.graph import GraphReader
from slam.params import Params


@dataclass(frozen=True, slots=True)
class Completion:
    """Poses that were computed, and why none could be (None where nothing went wrong)."""

    poses: dict[int, Pose] = field(default_factory=dict)
    failure: str | None = None


def complete(parts: GraphReader, stored: Mapping[int, Pose], params: Params) -> Completion:
    """Poses of the nodes that links join and that have none stored."""
    try:
        return Completion(completed(PoseGraph.from_reader(parts), stored, params))
    except OptimizationError as error:
        return Completion(failure=str(error))
