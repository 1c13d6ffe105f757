"""``slamdeck serve``: browse and correct maps."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from server.cli.options import PORT, HostOption, NameOption, NoTokenOption, PortOption, SourcesOption, TokenOption
from server.errors import SettingsError

if TYPE_CHECKING:
    from server.app import FirstRun
    from server.services import Services
    from server.settings import Settings


def serve(
    paths: Annotated[list[Path], typer.Argument(metavar="PATH...", help="Map files, and folders of map files.")],
    host: HostOption = "127.0.0.1",
    port: PortOption = PORT,
    token: TokenOption = None,
    no_token: NoTokenOption = False,
    name: NameOption = None,
    sources: SourcesOption = None,
) -> None:
    """Serve maps to browsers; prints one address, with the token, that opens the page."""
    check_paths(paths)
    folders = [path for path in paths if path.is_dir()]
    serve_maps(settings_of(paths, [*folders, *(sources or [])], host, port, token, no_token, name))


def check_paths(paths: Sequence[Path]) -> None:
    """Raises SettingsError for what is not there, DatabaseError for a file that is no map."""
    from slam.database import MapReader

    for path in paths:
        if not path.exists():
            raise SettingsError(f"{path} does not exist: name a map file or a folder of map files")
        if not path.is_dir():
            MapReader(path)


def settings_of(
    roots: Sequence[Path],
    sources: Sequence[Path],
    host: str,
    port: int,
    token: str | None,
    no_token: bool,
    names: Sequence[str] | None,
) -> Settings:
    """The settings that the options mean; SettingsError when they are not safe."""
    from server.settings import Settings, new_token

    chosen = None if no_token else token or new_token()
    return Settings(tuple(roots), tuple(sources), host, port, chosen, tuple(names or ()))


def serve_maps(settings: Settings, first_run: FirstRun | None = None, note: str = "") -> None:
    """Serve until SIGINT or SIGTERM."""
    from server.app import create_app
    from server.serving import bind, link
    from server.serving import serve as serve_app
    from server.static import web_folder

    web = web_folder()
    listening = bind(settings)
    address = link(settings, listening)

    def ready() -> None:
        if note:
            typer.echo(note, err=True)
        typer.echo(address)

    app = create_app(settings, web, first_run)
    services: Services = app.state.services
    # A run makes the map that is looked at first.
    serve_app(app, listening, ready, services.read_ahead if first_run is None else lambda: None)
