"""Headers that say what our pages may do (Content-Security-Policy and its kin)."""

from __future__ import annotations

import base64
import hashlib
import re
from pathlib import Path

_IMPORT_MAP = re.compile(r'<script type="importmap">(.*?)</script>', re.DOTALL)

_COMMON = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), microphone=(), geolocation=(), usb=(), serial=()",
}

#: Documents with this share a process with each other, not with the page, where a browser can (and the address is
#: https or this machine): WebGL may keep a thread waiting for seconds, above all where it draws in software.
_ISOLATED = {"Document-Isolation-Policy": "isolate-and-require-corp"}

#: viser's client unpacks itself with WebAssembly into inline script and style, talks from a worker made of a blob, and
#: has another one (for Gaussian splats) whose code makes functions out of text as soon as it starts.
_VISER = (
    "default-src 'none'; script-src 'self' 'unsafe-inline' 'unsafe-eval' 'wasm-unsafe-eval' blob:; "
    "worker-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "font-src 'self' data:; connect-src 'self' data: blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'self'"
)


def page_headers(index: Path | None) -> dict[str, str]:
    """Headers of the page and the API: only our own files, and the import map of ``index.html`` by its hash."""
    hashes = "".join(f" 'sha256-{digest}'" for digest in import_map_hashes(index))
    policy = (
        f"default-src 'none'; script-src 'self'{hashes}; style-src 'self'; img-src 'self' data: blob:; "
        "connect-src 'self'; font-src 'self'; frame-src 'self'; manifest-src 'self'; base-uri 'none'; "
        "form-action 'self'; frame-ancestors 'self'"
    )
    return {"Content-Security-Policy": policy, **_COMMON}


def viser_headers() -> dict[str, str]:
    """Headers of the 3D view, which is a page of its own in a frame."""
    return {"Content-Security-Policy": _VISER, **_ISOLATED, **_COMMON}


def frame_headers() -> dict[str, str]:
    """Headers of the document around the 3D view."""
    return {**page_headers(None), **_ISOLATED}


def import_map_hashes(index: Path | None) -> list[str]:
    """Base64 SHA-256 of every inline import map of a page."""
    if index is None or not index.is_file():
        return []
    found = _IMPORT_MAP.findall(index.read_text(encoding="utf-8"))
    return [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in found]
