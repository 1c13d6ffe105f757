"""Fronts of furniture and fittings."""

from __future__ import annotations

import numpy as np

from slam.sensors.tour.paint.canvas import Canvas, Color, Painter, rgb
from slam.sensors.tour.paint.materials import WALNUT, wood
from slam.sensors.tour.paint.posters import INK, PAPER, SETS, lines_of_text, photo

SPINES = tuple(color for colors in SETS for color in colors)
STEEL = rgb(0xB8BCC0)


def book_case(color: Color = WALNUT, shelf: float = 0.34) -> Painter:
    """Shelves full of books, with a thing or two between."""

    def paint(canvas: Canvas) -> None:
        canvas.fill(rgb(0x2A221D))
        rows = max(1, round(canvas.height / shelf))
        columns = max(1, round(canvas.width / 0.8))
        dx, dy = canvas.width / columns, canvas.height / rows
        for row in range(rows):
            for column in range(columns):
                _shelf(canvas.part(column * dx, row * dy, dx, dy))
                board = canvas.part(column * dx, (row + 1) * dy - 0.025, dx, 0.025)
                board.fill(canvas.vary(color, 0.1))
                canvas.rect(column * dx - 0.012, row * dy, 0.024, dy, canvas.vary(color, 0.1))
        canvas.frame(0.022, color)

    return paint


def _shelf(shelf: Canvas) -> None:
    rng, floor = shelf.rng, shelf.height - 0.025
    x = 0.02
    while x < shelf.width - 0.04:
        if rng.random() < 0.10:
            wide = float(rng.uniform(0.09, 0.16))
            _thing(shelf.part(x, floor - 0.2, min(wide, shelf.width - x - 0.02), 0.2))
        else:
            wide = float(rng.uniform(0.018, 0.05))
            tall = floor * float(rng.uniform(0.62, 0.93))
            _book(shelf.part(x, floor - tall, wide, tall))
        x += wide + 0.002


def _book(book: Canvas) -> None:
    color = book.vary(book.pick(SPINES), 0.25)
    book.fill(color)
    trim = book.pick((PAPER, INK, rgb(0xD9B44A), rgb(0xC8C8C8)))
    for at in book.rng.uniform(0.06, 0.9, int(book.rng.integers(1, 4))):
        book.rect(0, float(at) * book.height, book.width, 0.012 * float(book.rng.integers(1, 4)), trim)
    book.rect(0, 0, 0.003, book.height, rgb(0x1A1613))


def _thing(part: Canvas) -> None:
    w, h = part.width, part.height
    part.fill(rgb(0x2A221D))
    color = part.vary(part.pick(SPINES), 0.2)
    if part.rng.integers(2):
        part.disc(w / 2, h - 0.06, 0.055, color)
        part.rect(w / 2 - 0.015, h - 0.16, 0.03, 0.06, color)
    else:
        photo(part.part(0.01, 0.06, w - 0.02, h - 0.06))
        part.part(0.01, 0.06, w - 0.02, h - 0.06).frame(0.01, PAPER)


def cabinet(color: Color, columns: int, rows: int, handle: Color = STEEL, grain: float = 1.0) -> Painter:
    """A front of doors or drawers with handles."""

    def paint(canvas: Canvas) -> None:
        wood(color, True, grain)(canvas)
        dx, dy = canvas.width / columns, canvas.height / rows
        for row in range(rows):
            for column in range(columns):
                x, y = column * dx, row * dy
                door = canvas.part(x + 0.006, y + 0.006, dx - 0.012, dy - 0.012)
                door.tint(np.full(door.image.shape[:2], float(canvas.rng.uniform(-0.08, 0.08)), np.float32))
                canvas.line([(x, y), (x + dx, y), (x + dx, y + dy), (x, y + dy), (x, y)], canvas.vary(INK, 0.2), 0.010)
                if dx > dy:
                    canvas.rect(x + dx / 2 - 0.07, y + 0.05, 0.14, 0.018, handle)
                else:
                    side = 0.05 if column % 2 else dx - 0.068
                    canvas.rect(x + side, y + dy / 2 - 0.07, 0.018, 0.14, handle)

    return paint


def door(color: Color, plate: str) -> Painter:
    """A panelled door with handle and plate."""

    def paint(canvas: Canvas) -> None:
        wood(color, True, 0.5)(canvas)
        w, h = canvas.width, canvas.height
        for y, tall in ((0.12, 0.62), (0.86, 0.55), (1.50, 0.50)):
            if y + tall < h:
                panel = canvas.part(0.15, y, w - 0.30, tall)
                panel.tint(np.full(panel.image.shape[:2], -0.12, np.float32))
                panel.frame(0.012, canvas.vary(INK, 0.3))
        canvas.rect(w - 0.13, 1.02, 0.035, 0.16, STEEL)
        canvas.rect(w - 0.20, 1.07, 0.10, 0.025, rgb(0x84888C))
        canvas.rect(w / 2 - 0.16, 0.55, 0.32, 0.12, PAPER)
        canvas.text(w / 2 - 0.14, 0.64, 0.06, plate, INK)
        canvas.frame(0.05, rgb(0xE7E2D6))

    return paint


def fridge(canvas: Canvas) -> None:
    """Two steel doors with magnets, postcards and a child's drawing."""
    canvas.fill(rgb(0xC9CDD0))
    canvas.tint(0.05 * canvas.noise(0.5, 0.01))
    rng, w, h = canvas.rng, canvas.width, canvas.height
    canvas.rect(0, 0.38 * h, w, 0.012, INK)
    canvas.rect(0.05, 0.14 * h, 0.03, 0.2 * h, rgb(0x77797C))
    canvas.rect(0.05, 0.42 * h, 0.03, 0.3 * h, rgb(0x77797C))
    for _ in range(15):
        x, y = float(rng.uniform(0.14, w - 0.18)), float(rng.uniform(0.05, 0.75 * h))
        card = canvas.part(x, y, float(rng.uniform(0.07, 0.16)), float(rng.uniform(0.07, 0.16)))
        if rng.integers(2):
            photo(card)
            card.frame(0.008, PAPER)
        else:
            card.fill(card.pick((PAPER, rgb(0xF7E27A), rgb(0xA9C7EC))))
            lines_of_text(card.part(0.01, 0.015, card.width - 0.02, card.height - 0.02), INK, 0.012)
        canvas.disc(x + 0.03, y + 0.01, 0.014, canvas.pick(SPINES))


def oven(canvas: Canvas) -> None:
    """Knobs, a handle and a dark window."""
    canvas.fill(rgb(0x3A3D40))
    w, h = canvas.width, canvas.height
    for k in range(5):
        canvas.disc((0.12 + 0.19 * k) * w, 0.1 * h, 0.022, STEEL)
    canvas.rect(0.08 * w, 0.2 * h, 0.84 * w, 0.03, STEEL)
    canvas.rect(0.12 * w, 0.34 * h, 0.76 * w, 0.5 * h, rgb(0x14161A))
    canvas.line([(0.14 * w, 0.6 * h), (0.86 * w, 0.6 * h)], rgb(0x6B6F73), 0.006)
    canvas.line([(0.14 * w, 0.72 * h), (0.86 * w, 0.72 * h)], rgb(0x6B6F73), 0.006)
    canvas.frame(0.008, INK)


def radiator(canvas: Canvas) -> None:
    """White ribs."""
    canvas.fill(rgb(0xE9E7E1))
    for k in range(int(canvas.width / 0.06)):
        canvas.rect(0.06 * k, 0.04, 0.018, canvas.height - 0.08, canvas.vary(rgb(0x9D9A93), 0.1))


def desk_top(color: Color) -> Painter:
    """A table seen from above: papers, notebooks, cups and pens."""

    def paint(canvas: Canvas) -> None:
        wood(color)(canvas)
        rng = canvas.rng
        for _ in range(int(9 * canvas.width * canvas.height) + 2):
            w, h = (0.21, 0.29) if rng.integers(2) else (float(rng.uniform(0.1, 0.2)), float(rng.uniform(0.1, 0.16)))
            x = float(rng.uniform(0.02, max(0.03, canvas.width - w - 0.02)))
            y = float(rng.uniform(0.02, max(0.03, canvas.height - h - 0.02)))
            sheet = canvas.part(x, y, w, h)
            sheet.fill(sheet.pick((PAPER, PAPER, *SPINES)))
            lines_of_text(sheet.part(0.02, 0.02, w - 0.04, h - 0.04), sheet.pick((INK, rgb(0x5B6B8C))), 0.013)
        for _ in range(3):
            x, y = float(rng.uniform(0.06, canvas.width - 0.06)), float(rng.uniform(0.06, canvas.height - 0.06))
            canvas.disc(x, y, 0.045, canvas.pick(SPINES))
            canvas.disc(x, y, 0.036, rgb(0x3B2416))

    return paint


def worktop(canvas: Canvas) -> None:
    """Speckled stone with boards, bowls and fruit."""
    canvas.fill(rgb(0x8C8A86))
    canvas.tint(0.14 * canvas.noise(0.01, 0.01) + 0.06 * canvas.noise(0.1, 0.1))
    rng = canvas.rng
    for _ in range(int(4 * canvas.width)):
        x, y = float(rng.uniform(0.1, canvas.width - 0.1)), float(rng.uniform(0.1, canvas.height - 0.1))
        radius = float(rng.uniform(0.05, 0.1))
        canvas.disc(x, y, radius, canvas.pick((PAPER, rgb(0x4F7C8A), rgb(0xC9733D))))
        for _ in range(4):
            a, b = rng.uniform(-0.5, 0.5, 2) * radius
            canvas.disc(x + float(a), y + float(b), 0.025, canvas.pick((rgb(0xB8322A), rgb(0xD9A12E), rgb(0x6F9A3A))))


def keyboard(canvas: Canvas) -> None:
    """Rows of keys."""
    canvas.fill(rgb(0x2B2D31))
    for row in range(5):
        for column in range(14):
            x, y = (0.01 + 0.07 * column) * canvas.width, (0.06 + 0.185 * row) * canvas.height
            canvas.rect(x, y, 0.055 * canvas.width, 0.15 * canvas.height, canvas.vary(rgb(0x55585E), 0.2))
