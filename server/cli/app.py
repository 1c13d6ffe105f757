"""All commands under one name; every refusal is one line and exit code 2."""

from __future__ import annotations

import logging
import sys

import typer

from server.cli.demo import demo
from server.cli.export import export
from server.cli.info import info
from server.cli.params import params
from server.cli.run import run
from server.cli.serve import serve
from slam.errors import SlamError

#: Exit codes: a refusal (as for a wrong option), and an interruption (128 + SIGINT).
_REFUSED = 2
_INTERRUPTED = 130


def make_app() -> typer.Typer:
    """The commands."""
    app = typer.Typer(
        name="slamdeck",
        help="RGB-D graph SLAM with a web dashboard; maps are RTAB-Map databases.",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
    )
    for command in (demo, run, serve, info, export, params):
        app.command()(command)
    return app


def main() -> None:
    """Entry point of ``slamdeck``."""
    logging.basicConfig(level=logging.WARNING, format="%(levelname)s %(name)s: %(message)s")
    try:
        make_app()()
    except SlamError as error:
        _end(str(error), _REFUSED)
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        _end(f"{where}{error.strerror or error}", _REFUSED)
    except KeyboardInterrupt:
        _end("stopped", _INTERRUPTED)


def _end(message: str, code: int) -> None:
    print(f"error: {message}" if code == _REFUSED else message, file=sys.stderr)
    sys.exit(code)
