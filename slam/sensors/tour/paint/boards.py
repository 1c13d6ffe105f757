"""What else is on walls: boards with notes, windows, screens, a clock and signs."""

from __future__ import annotations

import numpy as np

from slam.sensors.tour.paint.canvas import Canvas, Color, Painter, rgb
from slam.sensors.tour.paint.posters import INK, PAPER, SETS, lines_of_text, photo, plot


def cork_board(canvas: Canvas) -> None:
    """Notes, cards and photographs on cork."""
    canvas.fill(rgb(0xB98B5B))
    canvas.tint(0.16 * canvas.noise(0.008, 0.008) + 0.06 * canvas.noise(0.05, 0.05))
    papers = (rgb(0xF7E27A), rgb(0xF5F2E8), rgb(0x9FD3C7), rgb(0xF2A7A0), rgb(0xA9C7EC), rgb(0xF5F2E8), rgb(0xC9E39B))
    rng = canvas.rng
    for _ in range(int(16 * canvas.width * canvas.height)):
        w, h = rng.uniform(0.09, 0.24), rng.uniform(0.09, 0.22)
        x, y = rng.uniform(0.04, canvas.width - w - 0.04), rng.uniform(0.04, canvas.height - h - 0.04)
        note = canvas.part(float(x), float(y), float(w), float(h))
        _note(note, papers)
        canvas.disc(
            float(x + w / 2), float(y + 0.012), 0.009, canvas.pick((rgb(0xC1272D), rgb(0x1F4E8C), rgb(0xE0B32E)))
        )
    canvas.frame(0.03, rgb(0x7A5636))


def _note(note: Canvas, papers: tuple[Color, ...]) -> None:
    kind = int(note.rng.integers(4))
    if kind == 0:
        photo(note)
        note.frame(0.01, PAPER)
        return
    note.fill(note.pick(papers))
    if kind == 1:
        plot(note.part(0.015, 0.015, note.width - 0.03, note.height - 0.03), SETS[1])
    else:
        lines_of_text(note.part(0.015, 0.025, note.width - 0.03, note.height - 0.04), rgb(0x3A3C46), 0.012)


def white_board(canvas: Canvas) -> None:
    """Boxes, arrows and curves in four colours of marker."""
    canvas.fill(rgb(0xF3F5F6))
    rng, w, h = canvas.rng, canvas.width, canvas.height
    pens = (rgb(0x1D3FA5), rgb(0xB3262A), rgb(0x1E7B3A), rgb(0x22242A))
    last: tuple[float, float] | None = None
    for _ in range(int(5 * w * h) + 3):
        x, y = float(rng.uniform(0.06, w - 0.36)), float(rng.uniform(0.08, h - 0.30))
        bw, bh = float(rng.uniform(0.16, 0.3)), float(rng.uniform(0.1, 0.2))
        pen = canvas.pick(pens)
        canvas.line([(x, y), (x + bw, y), (x + bw, y + bh), (x, y + bh), (x, y)], pen, 0.008)
        lines_of_text(canvas.part(x + 0.02, y + 0.025, bw - 0.04, bh - 0.04), pen, 0.02)
        if last is not None:
            canvas.line([last, (x, y + bh / 2)], canvas.pick(pens), 0.006)
        last = (x + bw, y + bh / 2)
    t = np.linspace(0, 1, 50)
    curve = np.column_stack([(0.1 + 0.5 * t) * w, h * (0.85 - 0.25 * np.sin(9 * t) * t)])
    canvas.line(curve, pens[1], 0.009)
    canvas.frame(0.025, rgb(0xA4A8AC))


def chalk_menu(canvas: Canvas) -> None:
    """A blackboard with a menu."""
    canvas.fill(rgb(0x26312E))
    canvas.tint(0.25 * canvas.noise(0.3, 0.15))
    w, h = canvas.width, canvas.height
    chalk = rgb(0xE9E7DA)
    canvas.text(0.1 * w, 0.16 * h, 0.08 * h, "KITCHEN", rgb(0xF0C75E))
    for row, dish in enumerate(("SOUP", "BREAD", "PASTA", "CURRY", "SALAD", "CAKE", "TEA")):
        y = h * (0.29 + 0.1 * row)
        canvas.text(0.08 * w, y, 0.045 * h, dish, chalk)
        canvas.line([(0.45 * w, y), (0.72 * w, y)], chalk, 0.004)
        canvas.text(0.76 * w, y, 0.045 * h, f"{int(canvas.rng.integers(2, 14))}.{int(canvas.rng.integers(10))}", chalk)
    canvas.frame(0.03, rgb(0x8A6239))


def window(canvas: Canvas) -> None:
    """Sky and a skyline behind a frame with bars."""
    rng, w, h = canvas.rng, canvas.width, canvas.height
    sky = np.linspace(0, 1, canvas.image.shape[0], dtype=np.float32)[:, None, None]
    top, low = np.array(rgb(0x8FBDE8), np.float32), np.array(rgb(0xE8F1F7), np.float32)
    np.copyto(canvas.image, (top * (1 - sky) + low * sky).astype(np.uint8))
    x = -0.05
    while x < w:
        wide, tall = float(rng.uniform(0.12, 0.3)), h * float(rng.uniform(0.2, 0.65))
        house = canvas.part(max(x, 0.0), h - tall, wide, tall)
        house.fill(canvas.vary(canvas.pick((rgb(0x9C8F86), rgb(0xB5694F), rgb(0x7C8B98), rgb(0xC9B79C))), 0.15))
        for row in range(int(tall / 0.06)):
            for column in range(int(wide / 0.05)):
                glass = canvas.pick((rgb(0x54636F), rgb(0xD9E4EC), rgb(0x3E4B55), rgb(0xF3DC9A)))
                house.rect(0.012 + 0.05 * column, 0.015 + 0.06 * row, 0.025, 0.034, glass)
        x += wide
    bar = rgb(0xF7F7F4)
    canvas.rect(w / 2 - 0.025, 0, 0.05, h, bar)
    canvas.rect(0, 0.34 * h, w, 0.04, bar)
    canvas.frame(0.06, bar)


def screen(canvas: Canvas) -> None:
    """A monitor: code in one half, a plot in the other."""
    canvas.fill(rgb(0x1B1E25))
    w, h, rng = canvas.width, canvas.height, canvas.rng
    inks = (rgb(0x7FC8F8), rgb(0xC792EA), rgb(0xA5D46A), rgb(0xF78C6C), rgb(0xD8DEE9))
    y = 0.07 * h
    while y < 0.92 * h:
        x = 0.05 * w + 0.03 * w * int(rng.integers(4))
        while x < 0.5 * w:
            word = w * float(rng.uniform(0.02, 0.09))
            canvas.rect(x, y, word, 0.025 * h, canvas.pick(inks))
            x += word + 0.012 * w
        y += 0.055 * h
    plot(canvas.part(0.56 * w, 0.1 * h, 0.38 * w, 0.36 * h), SETS[2])
    photo(canvas.part(0.56 * w, 0.52 * h, 0.38 * w, 0.38 * h))
    canvas.frame(0.012, rgb(0x0C0D10))


def clock(canvas: Canvas) -> None:
    """A wall clock in a square case."""
    s = canvas.width / 2
    canvas.fill(rgb(0x2D3138))
    canvas.disc(s, s, 0.92 * s, PAPER)
    for hour in range(12):
        angle = hour * np.pi / 6
        a, b = 0.72 * s, 0.86 * s
        canvas.line(
            [(s + a * np.cos(angle), s + a * np.sin(angle)), (s + b * np.cos(angle), s + b * np.sin(angle))], INK, 0.012
        )
    canvas.line([(s, s), (s + 0.5 * s, s - 0.35 * s)], INK, 0.014)
    canvas.line([(s, s), (s - 0.2 * s, s - 0.7 * s)], rgb(0xB3262A), 0.008)


def sign(text: str, ground: Color, ink: Color = PAPER) -> Painter:
    """A plate with one line of capital letters."""

    def paint(canvas: Canvas) -> None:
        canvas.fill(ground)
        size = min(0.5 * canvas.height, 1.05 * canvas.width / max(len(text), 1))
        canvas.text(0.08 * canvas.width, 0.5 * canvas.height + size / 2, size, text, ink)
        canvas.frame(0.012, ink)

    return paint
