"""A trial that becomes a map file of its own."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from shutil import copyfile

from slam.database import MapReader, MapWriter
from slam.errors import DatabaseError
from slam.tools.output import new_map


def keep(trial: Path, old_ids: Mapping[int, int], original: Path, output: Path) -> None:
    """Make a map file of a trial, with the images that its nodes have in the original.

    Args:
        trial: its map, without images.
        old_ids: its nodes -> those of the original.
        original: the map that was tried.
        output: the file to make.

    Raises:
        DatabaseError: the name is taken, the original is another map by now, or a file can't be read or written.
    """
    reader = MapReader(original)
    _check_same(MapReader(trial), reader, old_ids)
    with new_map(output, [original, trial]) as part:
        try:
            copyfile(trial, part)
        except OSError as error:
            raise DatabaseError(f"{output} can't be made: {error.strerror}") from error
        with MapWriter.open(part) as writer:
            writer.add_images((new_id, reader.stored_columns(old_id)[1]) for new_id, old_id in sorted(old_ids.items()))


def _check_same(trial: MapReader, original: MapReader, old_ids: Mapping[int, int]) -> None:
    """The images must be those of the nodes that were replayed: both have the same stamps."""
    tables = trial.nodes(), original.nodes()
    new, old = (dict(zip(table.ids.tolist(), table.stamps.tolist(), strict=True)) for table in tables)
    for new_id, old_id in old_ids.items():
        if old.get(old_id) != new.get(new_id):
            raise DatabaseError(
                f"{original} is another map than the one that was tried: node {old_id} is not the same any more; "
                "try the parameters again"
            )
