"""The viser server behind one view: reachable from this machine only, without any control of its own."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import rich
import viser

from server.scene.colours import Theme

_BARE = (
    "<style>.mantine-Paper-root, .mantine-Notifications-root"
    "{visibility: hidden !important; pointer-events: none !important}</style>"
)
_ROWS = 128


class Viewer(viser.ViserServer):
    """A viser server on a free port of the loopback interface."""

    def __init__(self) -> None:
        with _hushed():
            super().__init__(host="127.0.0.1", port=0, verbose=False)
        # viser 1.1 can't leave out its panel, only move it; a style sheet inside of it makes it invisible.
        self.gui.add_html(_BARE)
        self.scene.configure_environment_map(None)
        self.scene.configure_default_lights(enabled=False)
        self.scene.add_light_hemisphere("/light/sky", ground_color=(190, 190, 200), intensity=2.3)
        self.scene.add_light_directional("/light/sun", intensity=1.7, position=(3.0, -4.0, 9.0))

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Nobody may open a tunnel to the outside, whatever a client asks for."""
        del verbose
        return None

    def stop(self) -> None:
        """Close the port."""
        with _hushed():
            super().stop()

    def show_theme(self, look: Theme, *, dark: bool) -> None:
        """The background, and what the page shows until it is there."""
        self.gui.configure_theme(dark_mode=dark, show_logo=False, show_share_button=False)
        top, bottom = np.array(look.background, dtype=np.float64)
        share = np.linspace(0.0, 1.0, _ROWS)[:, None]
        gradient = np.rint(top * (1.0 - share) + bottom * share).astype(np.uint8)
        self.scene.set_background_image(np.repeat(gradient[:, None], 4, axis=1), format="png")


@contextmanager
def _hushed() -> Iterator[None]:
    """viser greets and says farewell on standard output, which belongs to the command line."""
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before
