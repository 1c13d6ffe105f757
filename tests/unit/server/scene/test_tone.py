"""What is sent comes out of the browser's tone mapping as it was meant."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from server.scene.colours import DARK, LIGHT
from server.scene.tone import for_batch, for_line


def shown(light: NDArray[np.float64]) -> NDArray[np.float64]:
    """sRGB 0 to 255 of linear light, as three.js's ACESFilmicToneMapping shader makes it."""
    into = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
    out = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])
    v = into @ (light / 0.6)
    fitted = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081)
    mapped = (out @ fitted).clip(0, 1)
    return 255 * np.where(mapped <= 0.0031308, 12.92 * mapped, 1.055 * mapped ** (1 / 2.4) - 0.055)


def light_of_line(rgb: tuple[int, int, int]) -> NDArray[np.float64]:
    """Lines give their colour in sRGB."""
    value = np.array(rgb) / 255
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


muted = st.integers(90, 200)


@given(muted, muted, muted)
def test_a_muted_colour_is_shown_exactly(r: int, g: int, b: int) -> None:
    assert np.abs(shown(light_of_line(for_line((r, g, b)))) - (r, g, b)).max() < 6
    batch = for_batch(np.array([[r, g, b]], dtype=np.uint8))
    assert np.abs(shown(batch[0] / 255) - (r, g, b)).max() < 6


def test_the_colours_of_both_themes_keep_their_hue() -> None:
    for look in (DARK, LIGHT):
        for rgb in (look.stm, look.wm, look.ltm, look.loop, look.user, look.odometry, look.truth):
            seen = shown(light_of_line(for_line(rgb)))
            assert np.argsort(seen).tolist() == np.argsort(rgb).tolist()
            assert np.abs(seen - rgb).max() < 35


def test_each_instance_of_a_batch_keeps_its_own_colour() -> None:
    colours = np.array([DARK.stm, DARK.wm, DARK.stm, LIGHT.loop], dtype=np.uint8)
    sent = for_batch(colours)
    np.testing.assert_array_equal(sent[0], sent[2])
    np.testing.assert_array_equal(sent[3], for_batch(colours[3:])[0])
    assert for_batch(colours[:0]).shape == (0, 3)
