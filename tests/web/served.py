"""The real program in processes of its own, as a person starts it."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from queue import Empty, Queue
from threading import Thread
from typing import IO

_ADDRESS = re.compile(r"https?://\S+")
_START_SECONDS = 60.0

#: Two rounds through the rendered flat, small and quick: loops from frame 210 on.
SMALL_TOUR = "tour:fps=5,width=320,height=240"


def command(*arguments: str) -> list[str]:
    """Command line of the program in this interpreter."""
    return [sys.executable, "-m", "server.cli", *arguments]


def make_map(path: Path, source: str) -> None:
    """Maps a source into a new file."""
    subprocess.run(command("run", source, "--db", str(path)), check=True, capture_output=True)


class Served:
    """A server process; ``url`` is the address that it printed, with the token."""

    def __init__(self, *arguments: str) -> None:
        self.process = subprocess.Popen(
            command(*arguments), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, bufsize=1
        )
        self.lines: Queue[str] = Queue()
        assert self.process.stdout is not None
        self._reader = Thread(target=self._read, args=(self.process.stdout,), daemon=True)
        self._reader.start()
        self.url = self._address()

    @property
    def base(self) -> str:
        """The address without the token."""
        return self.url.split("?")[0]

    def close(self) -> None:
        """Ends the process in order."""
        self.process.terminate()
        self._end()

    def kill(self) -> None:
        """Ends the process as a crash would."""
        self.process.kill()
        self._end()

    def _end(self) -> None:
        self.process.wait(30)
        self._reader.join(30)

    def _read(self, pipe: IO[str]) -> None:
        with pipe:
            for line in pipe:
                self.lines.put(line)

    def _address(self) -> str:
        said: list[str] = []
        while True:
            try:
                said.append(self.lines.get(timeout=_START_SECONDS))
            except Empty:
                self.process.kill()
                raise AssertionError(f"no address within {_START_SECONDS:g} s; it said: {''.join(said)}") from None
            found = _ADDRESS.search(said[-1])
            if found:
                return found[0]
