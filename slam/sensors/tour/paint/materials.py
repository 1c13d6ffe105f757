"""What walls, floors and furniture are made of."""

from __future__ import annotations

import numpy as np

from slam.sensors.tour.paint.canvas import Canvas, Color, Painter, rgb

OAK, WALNUT, BIRCH, BLACKENED = rgb(0xB58A5A), rgb(0x6E4A30), rgb(0xD9C29C), rgb(0x2E2C2B)


def plaster(color: Color, skirting: bool = True) -> Painter:
    """A painted wall, with a skirting board."""

    def paint(canvas: Canvas) -> None:
        canvas.fill(color)
        canvas.tint(0.018 * canvas.noise(0.9, 0.9) + 0.012 * canvas.noise(0.03, 0.03))
        if skirting:
            board = canvas.part(0, canvas.height - 0.10, canvas.width, 0.10)
            board.fill(rgb(0xF2EFE8))
            board.rect(0, 0, board.width, 0.008, rgb(0xB9B4AA))

    return paint


def wood(color: Color, upright: bool = False, grain: float = 1.0) -> Painter:
    """One board with grain along its length; painted wood shows less of it."""

    def paint(canvas: Canvas) -> None:
        canvas.fill(color)
        cells = ((0.02, 0.6), (0.006, 0.3)) if upright else ((0.6, 0.02), (0.3, 0.006))
        canvas.tint(np.float32(grain) * (0.065 * canvas.noise(*cells[0]) + 0.05 * canvas.noise(*cells[1])))

    return paint


def planks(canvas: Canvas) -> None:
    """An oak floor: boards of all lengths along x, each with its own tone."""
    canvas.fill(OAK)
    rng = canvas.rng
    rows, columns = canvas.image.shape[:2]
    tone = np.zeros((rows, columns), np.float32)
    scale_y, scale_x = rows / canvas.height, columns / canvas.width
    board = 0.145
    for row in range(int(np.ceil(canvas.height / board))):
        top, bottom = round(row * board * scale_y), round((row + 1) * board * scale_y)
        x = -float(rng.uniform(0, 1.2))
        while x < canvas.width:
            length = float(rng.uniform(0.7, 1.9))
            left, right = round(max(x, 0.0) * scale_x), round((x + length) * scale_x)
            tone[top:bottom, left:right] = rng.normal(0.0, 0.13)
            tone[top:bottom, right - 1 : right + 1] = -0.55
            x += length
        tone[bottom - 1 : bottom + 1] = -0.5
    canvas.tint(tone + 0.08 * canvas.noise(0.5, 0.012) + 0.05 * canvas.noise(0.15, 0.02))


def brick(canvas: Canvas) -> None:
    """A running bond of red bricks, no two alike."""
    canvas.fill(rgb(0xC9BFB2))
    rng = canvas.rng
    tones = (rgb(0xA8573F), rgb(0x9A4A36), rgb(0xB9694B), rgb(0x8A4638), rgb(0xB07A5E), rgb(0x7C4034))
    for row in range(int(np.ceil(canvas.height / 0.075))):
        x = -0.12 * (row % 2) - 0.06
        while x < canvas.width:
            dx, dy = rng.uniform(-0.004, 0.004, 2)
            color = canvas.vary(canvas.pick(tones), 0.22)
            canvas.rect(x + 0.006 + dx, row * 0.075 + 0.006 + dy, 0.228, 0.063, color)
            x += 0.24
    canvas.tint(0.07 * canvas.noise(0.02, 0.02) + 0.06 * canvas.noise(0.4, 0.4))


def motif_tiles(size: float, ground: Color, inks: tuple[Color, ...]) -> Painter:
    """Square tiles; each has one of a few ornaments, turned at random."""

    def paint(canvas: Canvas) -> None:
        canvas.fill(rgb(0xE4E0D8))
        for row in range(int(np.ceil(canvas.height / size))):
            for column in range(int(np.ceil(canvas.width / size))):
                tile = canvas.part(column * size + 0.003, row * size + 0.003, size - 0.006, size - 0.006)
                _ornament(tile, canvas.vary(ground, 0.06), canvas.pick(inks))

    return paint


def _ornament(tile: Canvas, ground: Color, ink: Color) -> None:
    tile.fill(ground)
    s = tile.width
    kind, turn = int(tile.rng.integers(5)), int(tile.rng.integers(4))
    x, y = ((0.0, 0.0), (s, 0.0), (s, s), (0.0, s))[turn]
    if kind == 0:
        tile.disc(x, y, 0.78 * s, ink, 90.0 * turn, 90.0 * turn + 90.0)
        tile.disc(x, y, 0.45 * s, ground, 90.0 * turn, 90.0 * turn + 90.0)
    elif kind == 1:
        tile.polygon([(s / 2, 0.08 * s), (0.92 * s, s / 2), (s / 2, 0.92 * s), (0.08 * s, s / 2)], ink)
        tile.disc(s / 2, s / 2, 0.18 * s, ground)
    elif kind == 2:
        corners = [(0.0, 0.0), (s, 0.0), (s, s), (0.0, s)]
        tile.polygon([corners[turn], corners[(turn + 1) % 4], corners[(turn + 2) % 4]], ink)
    elif kind == 3:
        tile.disc(s / 2, s / 2, 0.40 * s, ink)
        tile.disc(s / 2, s / 2, 0.26 * s, ground)
        tile.disc(s / 2, s / 2, 0.12 * s, ink)


def ceiling(lights: tuple[tuple[float, float, float, float], ...]) -> Painter:
    """White acoustic panels with vents and sprinklers; ``lights`` are x, y, width, height of the lamps."""

    def paint(canvas: Canvas) -> None:
        canvas.fill(rgb(0xECE9E2))
        rng = canvas.rng
        cell = 0.6
        for row in range(int(np.ceil(canvas.height / cell))):
            for column in range(int(np.ceil(canvas.width / cell))):
                panel = canvas.part(column * cell, row * cell, cell, cell)
                panel.fill(canvas.vary(rgb(0xE9E6DF), 0.04))
                _ceiling_fitting(panel, int(rng.integers(14)))
                panel.rect(0, 0, cell, 0.018, rgb(0xA9A69F))
                panel.rect(0, 0, 0.018, cell, rgb(0xA9A69F))
        canvas.tint(0.03 * canvas.noise(0.025, 0.025))
        for x, y, width, height in lights:
            canvas.rect(x - 0.03, y - 0.03, width + 0.06, height + 0.06, rgb(0x5B5A57))
            canvas.rect(x, y, width, height, (255, 255, 255))

    return paint


def _ceiling_fitting(panel: Canvas, kind: int) -> None:
    dark = rgb(0x6A6862)
    if kind == 0:
        for slot in range(5):
            panel.rect(0.12, 0.13 + 0.075 * slot, 0.36, 0.035, dark)
    elif kind == 1:
        panel.disc(0.3, 0.3, 0.10, dark)
        panel.disc(0.3, 0.3, 0.07, rgb(0xD7D4CC))
        panel.disc(0.3, 0.3, 0.02, dark)
    elif kind == 2:
        panel.disc(0.3, 0.3, 0.16, rgb(0xC5C2BA))
        panel.disc(0.3, 0.3, 0.13, rgb(0xF4F2EC))
    elif kind == 3:
        panel.rect(0.1, 0.1, 0.4, 0.4, rgb(0xBDB9B0))
        panel.line([(0.1, 0.1), (0.5, 0.5)], dark)
        panel.line([(0.5, 0.1), (0.1, 0.5)], dark)


def fabric(color: Color, stripe: Color | None = None) -> Painter:
    """Woven cloth, plain or with stripes of unequal width."""

    def paint(canvas: Canvas) -> None:
        canvas.fill(color)
        if stripe is not None:
            x = 0.0
            while x < canvas.width:
                wide = float(canvas.rng.uniform(0.015, 0.06))
                canvas.rect(x, 0, wide, canvas.height, canvas.vary(stripe, 0.15))
                x += wide + float(canvas.rng.uniform(0.02, 0.12))
        canvas.tint(0.06 * canvas.noise(0.012, 0.012) + 0.05 * canvas.noise(0.15, 0.15))

    return paint


def cardboard(canvas: Canvas) -> None:
    """A parcel's side: tape, a label, stamps."""
    canvas.fill(rgb(0xB48A5E))
    canvas.tint(0.04 * canvas.noise(0.3, 0.004) + 0.03 * canvas.noise(0.05, 0.05))
    w, h, rng = canvas.width, canvas.height, canvas.rng
    canvas.rect(0.44 * w, 0, 0.12 * w, h, rgb(0xC9A878))
    label = canvas.part(0.08 * w, 0.15 * h, 0.34 * w, 0.4 * h)
    label.fill(rgb(0xF3F0E6))
    x = 0.05 * label.width
    while x < 0.9 * label.width:
        bar = float(rng.uniform(0.01, 0.05)) * label.width
        label.rect(x, 0.5 * label.height, bar, 0.4 * label.height, rgb(0x22201E))
        x += bar + float(rng.uniform(0.02, 0.06)) * label.width
    for row in range(3):
        wide = float(rng.uniform(0.4, 0.9)) * label.width
        label.rect(0.05 * label.width, (0.1 + 0.12 * row) * label.height, wide, 0.05 * label.height, rgb(0x4A4744))
    ink = canvas.pick((rgb(0xA33327), rgb(0x27507F), rgb(0x2F2B28)))
    canvas.text(0.6 * w, 0.8 * h, 0.11 * h, canvas.rng.choice(["FRAGILE", "THIS UP", "BOOKS", "LAB 7"]), ink)
    canvas.polygon([(0.72 * w, 0.2 * h), (0.80 * w, 0.38 * h), (0.64 * w, 0.38 * h)], ink)
    canvas.rect(0.695 * w, 0.38 * h, 0.05 * w, 0.16 * h, ink)


def leaves(canvas: Canvas) -> None:
    """A dense hedge."""
    canvas.fill(rgb(0x1C2F1B))
    greens = (rgb(0x3F6B32), rgb(0x5A8A3F), rgb(0x2D5328), rgb(0x7FA852), rgb(0x47773B))
    for _ in range(int(1100 * canvas.width * canvas.height)):
        x, y = canvas.rng.uniform(0, canvas.width), canvas.rng.uniform(0, canvas.height)
        angle, length = canvas.rng.uniform(0, np.pi), canvas.rng.uniform(0.02, 0.05)
        along = np.array([np.cos(angle), np.sin(angle)]) * length
        across = np.array([-along[1], along[0]]) * 0.3
        tip = np.array([x, y])
        canvas.polygon(np.array([tip - along, tip + across, tip + along, tip - across]), canvas.pick(greens))


def rug(palette: tuple[Color, ...]) -> Painter:
    """A kilim: bands of diamonds, zigzags and steps."""

    def paint(canvas: Canvas) -> None:
        canvas.fill(palette[0])
        y = 0.10
        while y < canvas.height - 0.10:
            band = canvas.part(0.06, y, canvas.width - 0.12, float(canvas.rng.uniform(0.08, 0.26)))
            _rug_band(band, palette)
            y += band.height + 0.012
        canvas.frame(0.05, palette[1])
        canvas.frame(0.02, palette[2])
        canvas.tint(0.08 * canvas.noise(0.014, 0.014))

    return paint


def _rug_band(band: Canvas, palette: tuple[Color, ...]) -> None:
    rng, h = band.rng, band.height
    band.fill(band.pick(palette))
    kind, ink, second = int(rng.integers(4)), band.pick(palette), band.pick(palette)
    step = h * float(rng.uniform(0.8, 1.3))
    for i in range(int(band.width / step) + 1):
        x = i * step
        if kind == 0:
            band.polygon([(x, h / 2), (x + step / 2, 0.05 * h), (x + step, h / 2), (x + step / 2, 0.95 * h)], ink)
            band.disc(x + step / 2, h / 2, 0.15 * h, second)
        elif kind == 1:
            band.line([(x, 0.1 * h), (x + step / 2, 0.9 * h), (x + step, 0.1 * h)], ink, 0.2 * h)
        elif kind == 2:
            band.rect(x, 0.15 * h, 0.55 * step, 0.7 * h, ink if i % 2 else second)
        else:
            band.polygon([(x, h), (x + step / 2, 0), (x + step, h)], ink if rng.integers(2) else second)
