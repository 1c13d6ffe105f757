"""Fixtures that every kind of test shares."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import settings

ROOT = Path(__file__).resolve().parent.parent

# A busy machine is no failure: laws are judged by their examples, not by the time these take.
settings.register_profile("slamdeck", deadline=None)
settings.load_profile("slamdeck")


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Folder of real sequences and databases beside the checkout; tests that need it are skipped where it is absent."""
    folder = ROOT.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip("needs the real sequences of ../shared/data, which this machine does not have")
    return folder
