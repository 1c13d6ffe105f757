"""The files of the page."""

from __future__ import annotations

from pathlib import Path

from fastapi import Response
from starlette.staticfiles import StaticFiles
from starlette.types import Scope

from server.errors import SettingsError

_HERE = Path(__file__).resolve().parent


def web_folder() -> Path:
    """Where the page lies: beside this file in an installed package, else beside the package in a checkout.

    Raises:
        SettingsError: in neither place.
    """
    for folder in (_HERE / "web", _HERE.parent / "web"):
        if (folder / "index.html").is_file():
            return folder
    raise SettingsError(f"the page is missing: no index.html in {_HERE / 'web'} nor in {_HERE.parent / 'web'}")


class Page(StaticFiles):
    """Files that the browser asks for again each time: they are few, and an update must be seen at once."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """The file, or 404."""
        response = await super().get_response(path, scope)
        response.headers["Cache-Control"] = "no-cache"
        return response
