"""Tells Docker whether the server answers: without a token it must say 401, and nothing else."""

from __future__ import annotations

import sys
from urllib.error import HTTPError, URLError
from urllib.request import urlopen


def main() -> int:
    """0 when the server answers as it should."""
    try:
        urlopen("http://127.0.0.1:8080/api/maps", timeout=4)
    except HTTPError as error:
        return 0 if error.code == 401 else 1
    except URLError:
        return 1
    return 1


if __name__ == "__main__":
    sys.exit(main())
