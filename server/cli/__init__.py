"""The command line: every refusal is one line on stderr and exit code 2."""

from __future__ import annotations

import sys

from slam.errors import SlamError


def main() -> None:
    """Entry point of ``slamdeck``."""
    from typer import Abort, TyperException

    from server.cli.app import app

    try:
        sys.exit(app(sys.argv[1:] or ["--help"], standalone_mode=False))
    except TyperException as error:
        _refuse(f"{error.format_message().rstrip('.')}; --help after the command tells what it takes")
    except SlamError as error:
        _refuse(str(error))
    except (KeyboardInterrupt, Abort):
        _refuse("stopped by Ctrl+C")
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        _refuse(f"{place}{error.strerror or error}")


def _refuse(message: str) -> None:
    print(f"error: {' '.join(message.split())}", file=sys.stderr)
    sys.exit(2)
