"""A progress bar for work that goes frame by frame."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from slam.run import Tally
from slam.types import Update


@contextmanager
def progress(doing: str, frames: int) -> Iterator[Callable[[Update, Tally], None]]:
    """A bar on stderr; silent where stderr is no terminal."""
    columns = (
        TextColumn(doing),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[seen]}"),
        TimeRemainingColumn(),
    )
    terminal = Console(stderr=True)
    with Progress(*columns, console=terminal, transient=True, disable=not terminal.is_terminal) as bar:
        task = bar.add_task("", total=frames, seen="")
        nodes = loops = 0

        def advance(update: Update, tally: Tally) -> None:
            nonlocal nodes, loops
            nodes += update.node is not None
            loops += sum(candidate.refusal is None for candidate in update.candidates)
            bar.update(task, advance=1, seen=f"{nodes} nodes, {loops} loops, {tally.lost_frames} lost")

        yield advance
