"""The maps that are served, by the ids under which the page knows them."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from server.errors import UnknownMapError
from slam.errors import DatabaseError

_SUFFIX = ".db"
_DEPTH = 3
_SEPARATOR = "~"


@dataclass(frozen=True, slots=True)
class MapFile:
    """A map file: ``id`` in addresses, ``name`` for people (its path under the served folder), ``path``."""

    id: str
    name: str
    path: Path


class Catalog:
    """Finds map files under the served roots, and nothing outside them."""

    def __init__(self, roots: Sequence[Path]) -> None:
        self._roots = [root.resolve() for root in roots]
        self._lock = threading.Lock()
        self._known: dict[str, MapFile] = {}

    def files(self) -> list[MapFile]:
        """All map files, sorted by name; the folders are looked through anew."""
        with self._lock:
            self._known = {file.id: file for file in self._scan()}
            return sorted(self._known.values(), key=lambda file: file.name)

    def find(self, map_id: str) -> MapFile:
        """The file of an id; raises UnknownMapError when there is none."""
        with self._lock:
            known = self._known.get(map_id)
        if known is not None and known.path.is_file():
            return known
        found = next((file for file in self.files() if file.id == map_id), None)
        if found is None:
            raise UnknownMapError(f"no map is called {map_id!r} here; Maps lists those that are")
        return found

    def new_path(self, name: str) -> Path:
        """Where a new map of this name goes.

        Raises:
            DatabaseError: it exists, or no folder is served.
        """
        folder = next((root for root in self._roots if root.is_dir()), None)
        if folder is None:
            raise DatabaseError("no folder is served that a new map could go into: serve one instead of single files")
        path = folder / f"{name}{_SUFFIX}"
        if path.resolve().parent != folder or name.startswith("."):
            raise DatabaseError(f"{name!r} is no name of a file: use letters, digits, '-', '_' and '.'")
        if path.exists():
            raise DatabaseError(f"{path.name} exists already and is not overwritten: choose another name")
        return path

    def _scan(self) -> Iterator[MapFile]:
        taken: set[str] = set()
        for root in self._roots:
            for path, relative in _found_in(root):
                name = relative.removesuffix(_SUFFIX)
                map_id = _free(name.replace("/", _SEPARATOR), taken)
                taken.add(map_id)
                yield MapFile(map_id, name, path)


def _found_in(root: Path) -> Iterator[tuple[Path, str]]:
    if root.is_file():
        yield root, root.name
        return
    for folder, folders, names in os.walk(root):
        here = Path(folder)
        depth = len(here.relative_to(root).parts)
        folders[:] = sorted(name for name in folders if not name.startswith(".")) if depth < _DEPTH else []
        for name in sorted(names):
            path = here / name
            if name.endswith(_SUFFIX) and not name.startswith(".") and path.resolve().is_relative_to(root):
                yield path, path.relative_to(root).as_posix()


def _free(wanted: str, taken: set[str]) -> str:
    """The name, or with a number behind it when two served files have the same."""
    number, name = 2, wanted
    while name in taken:
        name, number = f"{wanted}-{number}", number + 1
    return name
