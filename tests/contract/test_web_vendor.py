"""What the page loads of others is what their packages hold, with licences, and nothing comes from elsewhere."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tests.contract.node_tools import WEB

VENDOR = WEB / "vendor"
OWN = [
    *WEB.glob("*.js"),
    *WEB.glob("views/*.js"),
    *WEB.glob("parts/*.js"),
    *WEB.glob("styles/*.css"),
    WEB / "index.html",
]
MAP_COMMENT = re.compile(r"\n?//# sourceMappingURL=.*\s*$")


def vendored_folders() -> list[Path]:
    return sorted(folder for folder in VENDOR.iterdir() if folder.is_dir())


def test_every_vendored_library_has_its_licence_and_version() -> None:
    listed = (VENDOR / "VERSIONS").read_text().splitlines()[2:]
    assert [folder.name for folder in vendored_folders()] == sorted(
        line.split()[0].removeprefix("@").replace("/", "-") for line in listed
    )
    for folder in vendored_folders():
        assert (folder / "LICENSE").read_text().strip()


def test_the_import_map_names_vendored_files_only() -> None:
    page = (WEB / "index.html").read_text()
    text = re.search(r'<script type="importmap">(.*?)</script>', page, re.S)
    assert text is not None
    for name, target in json.loads(text[1])["imports"].items():
        assert target.startswith("./vendor/"), name
        assert (WEB / target).is_file(), name


def test_the_page_has_no_inline_code_and_no_address_of_another_host() -> None:
    page = (WEB / "index.html").read_text()
    scripts = re.findall(r"<script([^>]*)>", page)
    assert len(scripts) == 2, "one import map and one module"
    assert not re.search(r"\s(style|on\w+)=", page)
    for path in OWN:
        found = re.findall(r"https?://[\w.]+", path.read_text())
        assert not [url for url in found if "www.w3.org" not in url], path.name


def test_versions_are_those_of_the_lock_file() -> None:
    lock = json.loads((WEB / "package-lock.json").read_text())["packages"]
    for line in (VENDOR / "VERSIONS").read_text().splitlines()[2:]:
        name, version = line.split()[:2]
        assert lock[f"node_modules/{name}"]["version"] == version


def test_the_lock_file_names_no_registry() -> None:
    lock = json.loads((WEB / "package-lock.json").read_text())["packages"]
    assert not [name for name, entry in lock.items() if "resolved" in entry]


@pytest.mark.parametrize(
    ("package", "inside", "here"),
    [
        ("preact", "dist/preact.mjs", "preact/preact.js"),
        ("preact", "hooks/dist/hooks.mjs", "preact/hooks.js"),
        ("htm", "dist/htm.mjs", "htm/htm.js"),
        ("@preact/signals", "dist/signals.mjs", "preact-signals/signals.js"),
        ("@preact/signals-core", "dist/signals-core.mjs", "preact-signals-core/signals-core.js"),
        ("uplot", "dist/uPlot.esm.js", "uplot/uplot.js"),
    ],
)
def test_vendored_code_is_the_packages_own(package: str, inside: str, here: str) -> None:
    original = WEB / "node_modules" / package / inside
    if not original.is_file():
        pytest.skip("needs web/node_modules: run `npm ci` in web/")
    assert (VENDOR / here).read_text().strip() == MAP_COMMENT.sub("", original.read_text()).strip()
