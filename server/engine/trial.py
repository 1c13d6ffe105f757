"""What runs in the process of a trial: it replays, compares, and leaves the outcome in a file."""

from __future__ import annotations

import json
import signal
import time
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from slam.errors import DatabaseError, SlamError
from slam.tools.wanted import Wanted

#: Files in the folder of a trial.
MAP, OUTCOME, NODES = "map.db", "outcome.json", "nodes.json"
_TOLD_SECONDS = 0.2


@dataclass(frozen=True, slots=True, eq=False)
class TrialJob:
    """A trial to carry out: what is wanted, the replay as it was (made where it is missing), and its own folder."""

    wanted: Wanted
    baseline: Path
    folder: Path


def trial_main(answers: Connection[Any, Any], job: TrialJob) -> None:
    """Carry out a trial; tells (share, text) on the way, and at the end None or what refused it."""
    # Ctrl+C in a terminal reaches every process of the program: the server says when to stop.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        _carry_out(answers, job)
        answers.send(None)
    except SlamError as error:
        answers.send(error)
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        answers.send(DatabaseError(f"{place}{error.strerror or error} ({job.folder})"))


def _carry_out(answers: Connection[Any, Any], job: TrialJob) -> None:
    from server.browse.trial_outcome import trial_comparison
    from slam.database import MapReader
    from slam.saving import save
    from slam.tools.trial import carry_out

    told = 0.0

    def tell(share: float, text: str) -> None:
        nonlocal told
        if time.monotonic() - told > _TOLD_SECONDS:
            told = time.monotonic()
            answers.send((share, text))

    found = carry_out(job.wanted, job.baseline, job.folder / MAP, tell)
    save(job.folder / NODES, json.dumps(found.old_ids))
    save(job.folder / OUTCOME, trial_comparison(MapReader(job.wanted.path), found).model_dump_json(by_alias=True))
