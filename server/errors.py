"""What the server itself refuses."""

from __future__ import annotations

from slam.errors import SlamError


class SettingsError(SlamError):
    """The server can't be started like this."""


class UnknownMapError(SlamError):
    """No map has this id."""


class NotFoundError(SlamError):
    """A map has no such node, link or data."""


class QueryError(SlamError):
    """What somebody looks for is not understood."""


class EngineError(SlamError):
    """The engine is not there, or is not in a state for what is asked of it."""


class EngineGoneError(EngineError):
    """The engine had ended before it took up what was asked of it."""
