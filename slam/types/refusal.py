"""Why something was not done."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why something was not done: the test that failed, its value, and the threshold it missed.

    ``test`` is a parameter name where one decides (``Vis/MinInliers``), else a short noun (``depth``).
    """

    test: str
    value: float
    threshold: float
    text: str
