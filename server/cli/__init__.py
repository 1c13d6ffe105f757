"""The command line: every refusal is one line on stderr and exit code 2."""

from __future__ import annotations

import sys

from slam.errors import SlamError


def main() -> None:
    """Entry point of ``slamdeck``."""
    from server.cli.app import app

    try:
        app()
    except SlamError as error:
        _refuse(str(error))
    except KeyboardInterrupt:
        _refuse("stopped by Ctrl+C")
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        _refuse(f"{place}{error.strerror or error}")


def _refuse(message: str) -> None:
    print(f"error: {' '.join(message.split())}", file=sys.stderr)
    sys.exit(2)
