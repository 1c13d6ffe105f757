"""What the server asks of an engine's process, and the jobs that such a process is made for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from slam.edit.wishes import CovarianceEdit, Detection, LinkEdit, Optimisation, PriorEdit, Refinement, Regrid, Turn
from slam.params import Value
from slam.types import Candidate


@dataclass(frozen=True, slots=True)
class RunJob:
    """Map a source into a file.

    Attributes:
        source: address of the source.
        path: the file to make, or to go on with.
        params: values that differ from the defaults.
        seed: of everything random.
        speed: times real time, by the frames' stamps; 0 is as fast as possible.
        overwrite: replace a file that is there.
        append: go on with a file that is there, as a new session of it.
    """

    source: str
    path: Path
    params: Mapping[str, Value] = field(default_factory=dict)
    seed: int = 0
    speed: float = 0.0
    overwrite: bool = False
    append: bool = False


@dataclass(frozen=True, slots=True)
class EditJob:
    """Change an existing file as people decide."""

    path: Path


Job = RunJob | EditJob


@dataclass(frozen=True, slots=True)
class Pause:
    """Stop before the next frame and wait."""


@dataclass(frozen=True, slots=True)
class Resume:
    """Go on."""


@dataclass(frozen=True, slots=True)
class Step:
    """Process one frame, then wait."""


@dataclass(frozen=True, slots=True)
class Stop:
    """Close the map and end."""


@dataclass(frozen=True, slots=True)
class SetParams:
    """Change parameters of a run from the next frame on, or of a map that nobody makes; answered with all values."""

    changes: Mapping[str, Value]


@dataclass(frozen=True, slots=True)
class Decide:
    """Carry out a person's decision; answered with its effect.

    Attributes:
        action: what to do.
        loops: both ids of each loop to approve or reject; undo and redo name none.
        author: who decides.
        preview: only work out what it would do.
        tried: loops that were looked at outside of the map, of those that are approved.
    """

    action: Literal["approve", "reject", "undo", "redo"]
    loops: tuple[tuple[int, int], ...] = ()
    author: str = ""
    preview: bool = False
    tried: tuple[Candidate, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class EditLink:
    """Edit a link, or only work out what that would do; answered with its outcome."""

    edit: LinkEdit
    preview: bool = False


@dataclass(frozen=True, slots=True)
class DropNodes:
    """Take nodes out of the map, or only work out what that would do; answered with its effect."""

    node_ids: tuple[int, ...]
    author: str = ""
    preview: bool = False


@dataclass(frozen=True, slots=True)
class LabelNodes:
    """Give nodes a label, numbered where they are several, or take it away (empty); answered with its effect."""

    node_ids: tuple[int, ...]
    label: str
    author: str = ""
    preview: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class EditPrior:
    """Give a node a prior, change or remove it; answered with its effect."""

    edit: PriorEdit
    preview: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class EditCovariances:
    """Give many links other covariances; answered with the effect."""

    edit: CovarianceEdit
    preview: bool = False


@dataclass(frozen=True, slots=True)
class KeepPoses:
    """Make the poses of an optimisation those of the map; answered with its effect."""

    wanted: Optimisation
    preview: bool = False


@dataclass(frozen=True, slots=True)
class TurnMap:
    """Turn the whole map as it is; answered with its effect."""

    wanted: Turn
    preview: bool = False


@dataclass(frozen=True, slots=True)
class StartJob:
    """Begin long work on the map; answered at once, its events tell of it.

    Attributes:
        number: by which its events name it.
        wanted: what to do.
        author: who wants it.
    """

    number: int
    wanted: Detection | Refinement | Regrid
    author: str = ""


@dataclass(frozen=True, slots=True)
class CancelJob:
    """Stop the job of this number; what it did so far is forgotten."""

    number: int


Change = DropNodes | LabelNodes | EditPrior | EditCovariances | KeepPoses | TurnMap
Edit = EditLink | Change
Command = Pause | Resume | Step | Stop | SetParams | Decide | Edit | StartJob | CancelJob


@dataclass(frozen=True, slots=True)
class Request:
    """A command with the number under which its answer comes."""

    number: int
    command: Command
