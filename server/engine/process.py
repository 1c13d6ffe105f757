"""What runs in an engine's process."""

from __future__ import annotations

import signal
from multiprocessing.connection import Connection

from server.engine.channel import Channel
from server.engine.commands import Job, Request, RunJob
from server.engine.events import Ended, Event
from slam.errors import DatabaseError, SlamError


def engine_main(connection: Connection[Event, Request], job: Job) -> None:
    """Do a job from start to end; whatever refuses it is told to the server.

    Ctrl+C in a terminal reaches every process of the program: here it is ignored, the server says when to stop.
    """
    channel = Channel(connection)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda *_: channel.request_stop())
    try:
        ended = _carry_out(job, channel)
    except SlamError as error:
        ended = Ended("failed", error)
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        ended = Ended("failed", DatabaseError(f"{place}{error.strerror or error} ({job.path.name})"))
    channel.send(ended)


def _carry_out(job: Job, channel: Channel) -> Ended:
    # Each kind imports what it needs and no more: the time until a map can be edited is time that somebody waits.
    if isinstance(job, RunJob):
        from server.engine.runner import Runner

        return Runner(job, channel).run()
    from server.engine.editor import Editor

    return Editor(job, channel).run()
