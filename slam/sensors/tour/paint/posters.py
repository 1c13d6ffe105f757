"""Pictures for walls: posters, maps, charts and photographs."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from slam.sensors.tour.paint.canvas import Canvas, Color, Painter, rgb

PAPER, INK = rgb(0xF4F0E4), rgb(0x24262B)
SETS: tuple[tuple[Color, ...], ...] = (
    (rgb(0xF2E8CF), rgb(0xBC4749), rgb(0x386641), rgb(0xA7C957), rgb(0x2F3E46)),
    (rgb(0xFDF0D5), rgb(0xC1121F), rgb(0x003049), rgb(0x669BBC), rgb(0xE9A23B)),
    (rgb(0xF1FAEE), rgb(0xE63946), rgb(0x457B9D), rgb(0x1D3557), rgb(0xF4A261)),
    (rgb(0xEDEDE9), rgb(0x5F0F40), rgb(0xFB8B24), rgb(0x0F4C5C), rgb(0xE36414)),
    (rgb(0xFEFAE0), rgb(0x606C38), rgb(0xDDA15E), rgb(0x283618), rgb(0xBC6C25)),
)
WORDS = ("ATLAS", "ORBIT", "DELTA", "FORM", "NORD", "ECHO", "RIVER", "SALT", "MOON", "ARC", "KITE", "OPUS", "TERRA")


def framed(content: Painter, frame: Color = INK, mat: float = 0.05) -> Painter:
    """A picture behind a frame and a white mat."""

    def paint(canvas: Canvas) -> None:
        canvas.fill(PAPER)
        canvas.frame(0.022, frame)
        edge = 0.022 + mat
        content(canvas.part(edge, edge, canvas.width - 2 * edge, canvas.height - 2 * edge))

    return paint


def geometric(canvas: Canvas) -> None:
    """Quarter circles, discs and stripes on a grid."""
    rng, colors = canvas.rng, SETS[int(canvas.rng.integers(len(SETS)))]
    canvas.fill(colors[0])
    columns = int(rng.integers(3, 6))
    s = canvas.width / columns
    for row in range(int(np.ceil(canvas.height / s))):
        for column in range(columns):
            cell = canvas.part(column * s, row * s, s, s)
            cell.fill(cell.pick(colors))
            _shape(cell, s, cell.pick(colors), cell.pick(colors))


def _shape(cell: Canvas, s: float, ink: Color, second: Color) -> None:
    kind, turn = int(cell.rng.integers(6)), int(cell.rng.integers(4))
    x, y = ((0.0, 0.0), (s, 0.0), (s, s), (0.0, s))[turn]
    if kind <= 1:
        cell.disc(x, y, s, ink, 90.0 * turn, 90.0 * turn + 90.0)
        cell.disc(x, y, 0.5 * s, second, 90.0 * turn, 90.0 * turn + 90.0)
    elif kind == 2:
        cell.disc(s / 2, s / 2, 0.42 * s, ink)
        cell.disc(s / 2, s / 2, 0.2 * s, second)
    elif kind == 3:
        for stripe in range(4):
            cell.rect(0, stripe * s / 4, s, s / 8, ink)
    elif kind == 4:
        corners = [(0.0, 0.0), (s, 0.0), (s, s), (0.0, s)]
        cell.polygon([corners[turn], corners[(turn + 1) % 4], corners[(turn + 2) % 4]], ink)


def landscape(canvas: Canvas) -> None:
    """Hills behind hills under a sun."""
    rng, colors = canvas.rng, SETS[int(canvas.rng.integers(len(SETS)))]
    w, h = canvas.width, canvas.height
    canvas.fill(colors[0])
    canvas.disc(w * float(rng.uniform(0.2, 0.8)), h * float(rng.uniform(0.2, 0.4)), 0.13 * w, colors[1])
    x = np.linspace(0, w, 60)
    for layer in range(5):
        base = h * (0.42 + 0.12 * layer)
        ridge = sum(h * 0.09 / (k + 1) * np.sin((k + 1) * 4.0 * x / w + rng.uniform(0, 6.28)) for k in range(4))
        line = np.column_stack([x, base + ridge])
        canvas.polygon(np.vstack([line, [[w, h], [0, h]]]), canvas.vary(colors[1 + layer % 4], 0.15))
        for _ in range(9):
            tree, size = int(rng.integers(len(x))), h * float(rng.uniform(0.015, 0.04))
            tx, ty = line[tree]
            canvas.polygon([(tx - size, ty), (tx, ty - 3 * size), (tx + size, ty)], canvas.vary(colors[4], 0.3))


def headline(canvas: Canvas) -> None:
    """A typographic poster."""
    rng, colors = canvas.rng, SETS[int(canvas.rng.integers(len(SETS)))]
    w, h = canvas.width, canvas.height
    canvas.fill(colors[0])
    canvas.rect(0, 0, w, h * float(rng.uniform(0.3, 0.5)), canvas.pick(colors[1:]))
    canvas.disc(w * float(rng.uniform(0.3, 0.8)), h * 0.3, 0.22 * w, canvas.pick(colors[1:]))
    size = 0.17 * w
    for row in range(2):
        canvas.text(0.06 * w, h * 0.66 + row * 1.35 * size, size, str(rng.choice(WORDS)), canvas.pick(colors[1:]))
    lines_of_text(canvas.part(0.06 * w, 0.86 * h, 0.88 * w, 0.11 * h), INK, 0.012)


def lines_of_text(canvas: Canvas, ink: Color, size: float) -> None:
    """Words too small to read, as dashes."""
    y = 0.0
    while y < canvas.height - size:
        x, end = 0.0, canvas.width * float(canvas.rng.uniform(0.55, 1.0))
        while x < end:
            word = size * float(canvas.rng.uniform(1.0, 5.0))
            canvas.rect(x, y, min(word, end - x), 0.6 * size, ink)
            x += word + 0.8 * size
        y += 1.7 * size


def city_map(canvas: Canvas) -> None:
    """Blocks, parks, a river and rail lines."""
    rng, w, h = canvas.rng, canvas.width, canvas.height
    canvas.fill(rgb(0xEFE9DA))
    tones = (rgb(0xD9CFB8), rgb(0xE3D9C6), rgb(0xC8D6A8), rgb(0xD8C3A5), rgb(0xE8C9B0), rgb(0xB9CBA0))
    y = 0.0
    while y < h:
        deep, x = float(rng.uniform(0.05, 0.11)), 0.0
        while x < w:
            wide = float(rng.uniform(0.04, 0.16))
            canvas.rect(x + 0.005, y + 0.005, wide - 0.01, deep - 0.01, canvas.pick(tones))
            x += wide
        y += deep
    t = np.linspace(-0.05, 1.05, 40)
    for color, thick in ((rgb(0x7FB2D0), 0.07), (rgb(0xC1453B), 0.012), (rgb(0x2F6DA8), 0.012), (rgb(0x3C8D5A), 0.012)):
        way = rng.uniform(0.2, 0.8) * h + 0.22 * h * np.sin(t * rng.uniform(3, 7) + rng.uniform(0, 6))
        canvas.line(np.column_stack([t * w, way]), color, thick)
        if thick < 0.02:
            for k in range(2, 40, 4):
                canvas.disc(float(t[k]) * w, float(way[k]), 0.013, INK)
                canvas.disc(float(t[k]) * w, float(way[k]), 0.008, PAPER)
    canvas.text(0.05 * w, h - 0.05, 0.05, "CITY PLAN", INK)


def botanical(canvas: Canvas) -> None:
    """A stem with leaves."""
    rng, w, h = canvas.rng, canvas.width, canvas.height
    canvas.fill(rgb(0xF3EEDF))
    green = canvas.pick((rgb(0x3A5A40), rgb(0x588157), rgb(0x1B4332), rgb(0x8A5A44)))
    canvas.line([(w / 2, 0.95 * h), (w * 0.48, 0.5 * h), (w / 2, 0.08 * h)], green, 0.012)
    for k in range(11):
        y = h * (0.86 - 0.07 * k)
        for side in (-1, 1):
            length, droop = w * float(rng.uniform(0.22, 0.42)), h * float(rng.uniform(0.02, 0.07))
            tip = (w / 2 + side * length, y - droop)
            middle = np.array([w / 2 + side * length / 2, y - droop / 2])
            canvas.polygon(
                [(w / 2, y), (middle[0], middle[1] - 0.025), tip, (middle[0], middle[1] + 0.025)],
                canvas.vary(green, 0.35),
            )
    lines_of_text(canvas.part(0.3 * w, 0.96 * h, 0.4 * w, 0.03 * h), INK, 0.008)


def chart_sheet(canvas: Canvas) -> None:
    """A scientific poster: title, columns, plots."""
    rng, w, h = canvas.rng, canvas.width, canvas.height
    canvas.fill(PAPER)
    colors = SETS[int(rng.integers(len(SETS)))]
    canvas.rect(0, 0, w, 0.14 * h, colors[3])
    canvas.text(0.05 * w, 0.1 * h, 0.06 * h, " ".join(rng.choice(WORDS, 2)), PAPER)
    for row in range(3):
        for column in range(2):
            cell = canvas.part((0.05 + 0.47 * column) * w, (0.18 + 0.27 * row) * h, 0.43 * w, 0.24 * h)
            if rng.integers(2):
                plot(cell, colors)
            else:
                lines_of_text(cell, rgb(0x4B4D52), 0.013)


def plot(cell: Canvas, colors: tuple[Color, ...]) -> None:
    """Bars or curves between two axes."""
    rng, w, h = cell.rng, cell.width, cell.height
    cell.fill(rgb(0xE6E6E6))
    if rng.integers(2):
        for k in range(8):
            tall = h * float(rng.uniform(0.15, 0.9))
            cell.rect((0.08 + 0.11 * k) * w, h - tall, 0.08 * w, tall, colors[1 + k % 4])
    else:
        x = np.linspace(0, w, 14)
        for color in colors[1:4]:
            cell.line(np.column_stack([x, h * rng.uniform(0.15, 0.9, 14)]), color, 0.008)
    cell.line([(0.02 * w, 0), (0.02 * w, 0.98 * h), (w, 0.98 * h)], INK, 0.006)


def photo(canvas: Canvas) -> None:
    """An out-of-focus photograph."""
    low, high = (np.array(canvas.pick(SETS[int(canvas.rng.integers(len(SETS)))]), np.float32) for _ in range(2))
    field = canvas.noise(canvas.width / 4, canvas.height / 4) + 0.5 * canvas.noise(
        canvas.width / 12, canvas.height / 12
    )
    mix = np.clip(0.5 + 0.5 * field, 0, 1)[..., None]
    np.copyto(canvas.image, (low * (1 - mix) + high * mix).astype(np.uint8))


ART: tuple[Painter, ...] = (geometric, landscape, headline, city_map, botanical, chart_sheet, photo)


def art(kind: int, frame: Color = INK) -> Painter:
    """One of the pictures, framed."""
    content: Callable[[Canvas], None] = ART[kind % len(ART)]
    return framed(content, frame)
