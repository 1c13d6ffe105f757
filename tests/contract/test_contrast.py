"""Colours of the page can be told apart in both themes, as WCAG 2.2 asks at level AA."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

TOKENS = Path(__file__).resolve().parents[2] / "web" / "styles" / "tokens.css"
GROUNDS = ("canvas", "panel", "raised", "hover", "accent-soft")
#: What words are written in (1.4.3), and what only marks and lines of charts are drawn in (1.4.11).
WORDS = ("ink", "ink-2", "ink-3", "accent", "good", "bad", "warn", "hand", "loop", "odom")
MARKS = ("stm", "wm", "ltm", "truth")
#: Words of one colour on a ground of their own.
BADGES = [(name, f"{name}-soft") for name in ("accent", "good", "bad", "warn", "hand")]
BADGES += [("accent-ink", "accent"), ("ink", "accent-soft"), ("ink-2", "quiet-soft"), ("ink-3", "quiet-soft")]


def theme(name: str) -> dict[str, str]:
    block = re.search(rf':root\[data-theme="{name}"\] \{{(.*?)\n\}}', TOKENS.read_text(), re.DOTALL)
    assert block
    return dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6});", block[1]))


def luminance(colour: str) -> float:
    """Relative luminance of ``#rrggbb`` (WCAG 2.2)."""
    channels = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return sum(weight * c for weight, c in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


def contrast(one: str, other: str) -> float:
    dark, light = sorted((luminance(one), luminance(other)))
    return (light + 0.05) / (dark + 0.05)


def test_contrast_is_that_of_wcag() -> None:
    assert contrast("#000000", "#ffffff") == pytest.approx(21.0)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.01)


@pytest.mark.parametrize("name", ["dark", "light"])
def test_words_and_marks_stand_out_from_every_ground(name: str) -> None:
    colours = theme(name)
    pairs = [(word, ground, 4.5) for ground in GROUNDS for word in WORDS]
    pairs += [(word, ground, 4.5) for word, ground in BADGES]
    pairs += [(mark, ground, 3.0) for ground in GROUNDS for mark in MARKS]
    weak = {
        f"{ink} on {ground}": round(contrast(colours[ink], colours[ground]), 2)
        for ink, ground, least in pairs
        if contrast(colours[ink], colours[ground]) < least
    }
    assert not weak
