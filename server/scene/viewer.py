"""viser's server: on the loopback only, on a free port, and quiet."""

from __future__ import annotations

import rich
import viser

from server.scene import palette


def open_viewer(name: str) -> viser.ViserServer:
    """A server with an empty scene, z up."""
    # viser prints to rich's global console, whatever it is told; the output of this program is its own.
    rich.get_console().quiet = True
    server = viser.ViserServer(host="127.0.0.1", port=0, label=name, verbose=False)
    server.gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False)
    server.gui.main_panel.minimize()
    server.scene.set_up_direction("+z")
    server.scene.world_axes.visible = False
    server.scene.configure_default_lights(cast_shadow=False)
    return server


def add_floor(server: viser.ViserServer, height: float) -> viser.GridHandle:
    """Fine lines at the height of the floor, that say where up is and how long a metre is."""
    return server.scene.add_grid(
        "/floor",
        infinite_grid=True,
        fade_distance=25.0,
        cell_size=1.0,
        section_size=5.0,
        cell_color=palette.FLOOR,
        section_color=palette.FLOOR,
        cell_thickness=0.5,
        section_thickness=0.9,
        position=(0.0, 0.0, height),
    )
