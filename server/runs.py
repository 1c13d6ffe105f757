"""Which sources a browser may have mapped."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from slam.errors import SourceError

_RENDERED = "tour:"


def checked_source(source: str, roots: Sequence[Path]) -> str:
    """The source, when it is the rendered tour or a folder under one of the roots.

    Raises:
        SourceError: it lies elsewhere. It is said in the same words whether it exists or not.
    """
    if source.startswith(_RENDERED):
        return source
    allowed = [root.resolve() for root in roots if root.is_dir()]
    candidates = [Path(source), *(root / source for root in allowed)]
    for candidate in candidates:
        path = candidate.resolve()
        if path.is_dir() and any(path.is_relative_to(root) for root in allowed):
            return str(path)
    under = ", ".join(str(root) for root in allowed) or "(none is allowed)"
    raise SourceError(f"{source!r} is no folder that this server may read: use {_RENDERED} or a folder under {under}")
