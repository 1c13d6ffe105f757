"""Puts the page into the wheel as server/web, without the tools that only check it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

#: In web/, but not part of the page.
_TOOLS = {"node_modules", "types", "package.json", "package-lock.json", "tsconfig.json", ".npmrc"}


class PageHook(BuildHookInterface[Any]):
    """Adds every file of the page; an editable install finds them in the checkout."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Called before the wheel is put together."""
        if version == "editable":
            return
        web = Path(self.root) / "web"
        for part in sorted(web.iterdir()):
            if part.name not in _TOOLS:
                build_data["force_include"][str(part)] = f"server/web/{part.name}"
