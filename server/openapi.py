"""Prints the API's description, out of which the page's types are made: ``python -m server.openapi``."""

from __future__ import annotations

import json
import sys

from server.app import create_app
from server.settings import Settings


def openapi_text() -> str:
    """OpenAPI of the server as JSON, the same for the same code."""
    schema = create_app(Settings(roots=())).openapi()
    # The version is that of the installed package, which says nothing about the API of this checkout.
    schema["info"]["version"] = "0"
    return json.dumps(schema, indent=2, sort_keys=True, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    sys.stdout.write(openapi_text())
