"""Fixtures that every kind of test shares."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import settings

ROOT = Path(__file__).resolve().parent.parent

# A busy machine is no failure: laws are judged by their examples, not by the time these take. The examples are the
# same in every run; HYPOTHESIS_PROFILE=explore looks for new ones.
settings.register_profile("slamdeck", deadline=None, derandomize=True)
settings.register_profile("explore", deadline=None)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "slamdeck"))


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Folder of real sequences and databases beside the checkout; tests that need it are skipped where it is absent."""
    folder = ROOT.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip("needs the real sequences of ../shared/data, which this machine does not have")
    return folder
