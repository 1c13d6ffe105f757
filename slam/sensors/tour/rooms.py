"""The flat of the tour: a ring of corridor, kitchen, lounge and study round an office. x is east, y is north."""

from __future__ import annotations

from slam.sensors.tour.face import Plan
from slam.sensors.tour.paint.boards import chalk_menu, clock, cork_board, screen, sign, white_board, window
from slam.sensors.tour.paint.canvas import rgb
from slam.sensors.tour.paint.furniture import (
    book_case,
    cabinet,
    desk_top,
    door,
    fridge,
    keyboard,
    oven,
    radiator,
    worktop,
)
from slam.sensors.tour.paint.materials import (
    BIRCH,
    BLACKENED,
    OAK,
    WALNUT,
    brick,
    cardboard,
    ceiling,
    fabric,
    leaves,
    motif_tiles,
    planks,
    plaster,
    rug,
    wood,
)
from slam.sensors.tour.paint.posters import art, city_map, framed

WIDTH, DEPTH, HEIGHT = 14.0, 10.0, 2.7
WHITE, SAGE, TEAL, CLAY = rgb(0xEDE8DD), rgb(0xA9B79B), rgb(0x2F6F73), rgb(0xC98A6B)
NAVY, MUSTARD, BLUSH, SLATE = rgb(0x2B3A55), rgb(0xD6A03A), rgb(0xD9A79A), rgb(0x6E7F8D)
#: Centres of the lamps in the ceiling; each is 1.2 by 0.6 m.
LAMPS = tuple((x, y) for y in (1.4, 4.4, 8.2) for x in (1.7, 4.7, 7.7, 10.4, 12.6))
WINDOWS = (2.3, 5.5, 8.6)
WINDOW_SIZE = (1.8, 1.4)
SILL = 0.9
#: Pictures hang this far before their wall.
_GAP = 0.012


def furnish() -> Plan:
    """The whole flat."""
    plan = Plan()
    for part in (_shell, _corridor, _kitchen, _lounge, _study, _office):
        part(plan)
    return plan


def _shell(plan: Plan) -> None:
    lamps = tuple((x - 0.6, y - 0.3, 1.2, 0.6) for x, y in LAMPS)
    plan.panel("up", (0, 0, 0), (WIDTH, DEPTH), planks, 140)
    plan.panel("down", (0, 0, HEIGHT), (WIDTH, DEPTH), ceiling(lamps), 80)
    plan.panel("north", (0, 0, 0), (WIDTH, HEIGHT), brick, 150)
    plan.panel("south", (0, DEPTH, 0), (WIDTH, HEIGHT), plaster(WHITE), 80)
    plan.panel("east", (0, 0, 0), (DEPTH, HEIGHT), plaster(SAGE), 80)
    plan.panel("west", (WIDTH, 0, 0), (DEPTH, HEIGHT), plaster(WHITE), 80)
    for x, y in LAMPS:
        plan.panel("down", (x - 0.6, y - 0.3, HEIGHT - 0.01), (1.2, 0.6), sign("", rgb(0xFFFDF6)), 60, glows=True)


def _corridor(plan: Plan) -> None:
    """South: a gallery wall opposite the bricks."""
    plan.block((3.0, 2.6, 0), (8.0, 0.15, HEIGHT), plaster(WHITE), 90, north=plaster(SLATE))
    x = 3.25
    for kind, wide, tall in ((0, 0.9, 1.2), (1, 1.2, 0.8), (5, 0.7, 1.0), (2, 0.8, 1.1), (3, 1.1, 1.1), (4, 0.6, 1.0)):
        plan.panel("south", (x, 2.6 - _GAP, 1.55 - tall / 2), (wide, tall), art(kind), 240)
        x += wide + 0.32
    plan.panel("south", (9.95, 2.6 - _GAP, 0), (0.95, 2.1), door(TEAL, "LAB 7"), 200)
    plan.panel("south", (9.98, 2.6 - _GAP, 2.18), (0.9, 0.24), sign("EXIT", rgb(0x1E7B3A)), 240)
    plan.panel("up", (4.0, 0.75, 0.008), (5.6, 1.1), rug((rgb(0x7A2E2E), NAVY, MUSTARD, rgb(0xE8D9B5), TEAL)), 200)
    plan.panel("north", (0.9, _GAP, 0), (0.95, 2.1), door(NAVY, "ROOM 1"), 200)
    plan.panel("north", (2.5, _GAP, 1.0), (1.6, 1.1), cork_board, 240)
    plan.block((2.4, 0, 0.12), (1.7, 0.12, 0.6), radiator)
    plan.block(
        (4.7, 0, 0),
        (1.8, 0.36, 1.8),
        wood(MUSTARD, grain=0.3),
        north=cabinet(MUSTARD, 4, 2, grain=0.3),
        up=desk_top(MUSTARD),
    )
    plan.block((5.0, 0.02, 1.8), (0.5, 0.32, 0.35), cardboard, 220)
    plan.block((5.7, 0.04, 1.8), (0.4, 0.28, 0.25), cardboard, 220)
    plan.panel("north", (6.8, _GAP, 0.9), (0.9, 1.3), art(2, WALNUT), 240)
    plan.panel("north", (8.0, _GAP, 0.9), (0.9, 1.3), art(0, WALNUT), 240)
    plan.block((7.0, 0, 0), (2.0, 0.36, 0.45), wood(OAK), up=fabric(TEAL, MUSTARD))
    plan.panel("north", (9.3, _GAP, 0.8), (1.5, 1.2), framed(city_map, BLACKENED), 240)
    plan.block((11.1, 0, 0), (1.3, 0.36, 2.1), wood(WALNUT), 200, north=book_case())
    plan.panel("north", (13.0, _GAP, 1.0), (0.7, 1.0), art(1, BLACKENED), 240)


def _kitchen(plan: Plan) -> None:
    """East: counter, tiles and wall cupboards; an island opposite."""
    steel, front = rgb(0xB8BCC0), cabinet(TEAL, 4, 1, grain=0.3)
    plan.block((13.4, 1.3, 0), (0.6, 0.8, 2.2), wood(BIRCH), west=cabinet(BIRCH, 1, 3, BLACKENED))
    plan.block((13.4, 2.2, 0), (0.6, 1.9, 0.9), wood(BIRCH), west=front, up=worktop)
    plan.block(
        (13.4, 4.1, 0),
        (0.6, 0.7, 0.9),
        plaster(steel, False),
        200,
        west=oven,
        up=motif_tiles(0.23, BLACKENED, (steel,)),
    )
    plan.block((13.4, 4.8, 0), (0.6, 2.4, 0.9), wood(BIRCH), west=front, up=worktop)
    tiles = motif_tiles(0.14, rgb(0xF2EFE6), (TEAL, NAVY, MUSTARD, CLAY))
    plan.panel("west", (WIDTH - _GAP, 2.2, 0.9), (5.0, 0.62), tiles, 240)
    plan.block((13.64, 2.2, 1.55), (0.36, 1.9, 0.7), wood(BIRCH), west=cabinet(BIRCH, 4, 1, BLACKENED))
    plan.block((13.5, 4.1, 1.75), (0.5, 0.7, 0.5), plaster(steel, False), west=sign("HOT", rgb(0x3A3D40)))
    plan.block((13.64, 4.8, 1.55), (0.36, 2.4, 0.7), wood(WALNUT), 200, west=book_case(WALNUT, 0.35))
    plan.block((13.3, 7.35, 0), (0.7, 0.75, 1.85), plaster(steel, False), 200, west=fridge, south=fridge)
    for y, wide, tall, color in (
        (2.5, 0.25, 0.35, CLAY),
        (3.3, 0.3, 0.22, MUSTARD),
        (5.3, 0.4, 0.28, NAVY),
        (6.4, 0.2, 0.38, BLUSH),
    ):
        plan.block((13.65, y, 0.9), (0.2, wide, tall), fabric(color, rgb(0xF2EFE6)), 220)
    plan.panel("west", (WIDTH - _GAP, 8.4, 0.9), (1.2, 1.3), art(4, WALNUT), 240)
    plan.panel("west", (WIDTH - _GAP, 0.25, 0.9), (0.85, 1.2), art(2, BLACKENED), 240)
    plan.block(
        (10.2, 3.9, 0), (0.8, 2.3, 0.95), wood(NAVY, grain=0.3), east=cabinet(NAVY, 4, 1, MUSTARD, 0.3), up=worktop
    )
    plan.block((10.4, 4.3, 0.95), (0.3, 0.4, 0.3), cardboard, 220)
    plan.block((10.45, 5.4, 0.95), (0.25, 0.25, 0.4), leaves, 200)
    plan.block((9.3, 2.75, 0), (0.15, 3.0, HEIGHT), plaster(TEAL), 90, west=plaster(WHITE))
    plan.panel("east", (9.45 + _GAP, 3.0, 0.9), (1.1, 1.4), chalk_menu, 240)
    plan.panel("east", (9.45 + _GAP, 4.4, 1.0), (1.1, 1.1), art(1, WALNUT), 240)
    plan.panel("up", (11.4, 3.4, 0.008), (1.5, 3.2), rug((TEAL, rgb(0xF0E6D2), CLAY, NAVY)), 200)


def _lounge(plan: Plan) -> None:
    """North: windows, a sofa, a television wall."""
    for x in WINDOWS:
        plan.panel("south", (x, DEPTH - _GAP, SILL), WINDOW_SIZE, window, 200, glows=True)
        plan.block((x - 0.32, 9.9, 0.35), (0.3, 0.1, 2.2), fabric(MUSTARD, CLAY), 120)
        plan.block((x + 1.82, 9.9, 0.35), (0.3, 0.1, 2.2), fabric(MUSTARD, CLAY), 120)
    plan.block((5.2, 9.4, 0), (2.4, 0.6, 0.42), fabric(NAVY))
    plan.block((5.2, 9.82, 0.42), (2.4, 0.18, 0.4), fabric(NAVY))
    for x, color, stripe in ((5.3, MUSTARD, NAVY), (5.95, BLUSH, TEAL), (6.95, CLAY, rgb(0xF2E8CF))):
        plan.block((x, 9.66, 0.42), (0.45, 0.14, 0.34), fabric(color, stripe), 200)
    plan.block((2.3, 9.62, 0), (1.8, 0.38, 0.5), wood(BLACKENED), up=leaves, south=cabinet(BIRCH, 3, 1))
    plan.block((2.35, 9.66, 0.5), (1.7, 0.3, 0.32), leaves, 200)
    plan.block((8.6, 9.62, 0), (1.8, 0.38, 0.62), wood(OAK), south=cabinet(OAK, 3, 2), up=desk_top(OAK))
    plan.block((8.8, 9.7, 0.62), (0.4, 0.25, 0.3), cardboard, 220)
    plan.block((11.0, 9.62, 0), (2.0, 0.38, 2.2), wood(BLACKENED), 200, south=book_case(BLACKENED, 0.31))
    plan.panel("south", (7.75, DEPTH - _GAP, 1.3), (0.5, 0.5), clock, 240)
    plan.panel("south", (4.45, DEPTH - _GAP, 1.0), (0.7, 1.0), art(5), 240)
    plan.block((5.0, 6.95, 0), (3.6, 0.12, 1.75), wood(WALNUT, True), 160, south=plaster(CLAY))
    plan.block((6.0, 7.07, 0.75), (1.5, 0.06, 0.85), wood(BLACKENED), 220, glows=True, north=screen)
    plan.block((5.2, 7.07, 0), (3.2, 0.3, 0.45), wood(OAK), north=cabinet(OAK, 4, 1), up=desk_top(OAK))
    plan.panel(
        "up", (4.7, 7.5, 0.008), (3.4, 1.75), rug((rgb(0x8C2F39), rgb(0xF1DCA7), NAVY, MUSTARD, rgb(0x4E6E58))), 220
    )
    plan.block((9.7, 6.8, 0), (0.4, 0.4, HEIGHT), brick, north=motif_tiles(0.2, WHITE, (NAVY, CLAY)), east=art(2))


def _study(plan: Plan) -> None:
    """West: a wall of books, desks opposite."""
    plan.block((0, 2.1, 0), (0.36, 3.4, 2.35), wood(WALNUT), 200, east=book_case())
    plan.panel("east", (_GAP, 5.8, 0), (0.95, 2.1), door(CLAY, "STUDIO"), 200)
    plan.panel("east", (_GAP, 7.1, 0.85), (1.9, 1.35), framed(city_map, WALNUT), 240)
    plan.panel("east", (_GAP, 0.5, 0.9), (1.0, 1.3), art(0, BLACKENED), 240)
    plan.block((0, 9.3, 0), (0.9, 0.7, 0.45), wood(BLACKENED), 160, up=leaves)
    plan.block((0.08, 9.38, 0.45), (0.74, 0.54, 0.75), leaves, 180)
    plan.panel("south", (1.05, DEPTH - _GAP, 0.9), (0.8, 1.1), art(3, WALNUT), 240)
    plan.panel("up", (0.6, 3.6, 0.008), (1.6, 3.4), rug((NAVY, rgb(0xE8D9B5), rgb(0xA23B2A), SAGE)), 200)
    for y in (3.2, 5.2):
        plan.block((3.0, y, 0.70), (0.8, 1.6, 0.04), wood(BIRCH), 200, up=desk_top(BIRCH))
        plan.block((3.05, y + 0.05, 0), (0.7, 0.06, 0.70), wood(BLACKENED))
        plan.block((3.05, y + 1.1, 0), (0.7, 0.45, 0.70), wood(BIRCH), west=cabinet(BIRCH, 1, 3), up=desk_top(BIRCH))
        plan.block((3.5, y + 0.35, 0.80), (0.04, 0.7, 0.42), wood(BLACKENED), 260, glows=True, west=screen)
        plan.block((3.5, y + 0.65, 0.74), (0.06, 0.1, 0.06), wood(BLACKENED))
        plan.block((3.15, y + 0.5, 0.74), (0.16, 0.45, 0.02), wood(BLACKENED), 260, up=keyboard)
    plan.block((3.1, 6.45, 0.74), (0.35, 0.25, 0.28), cardboard, 220)


def _office(plan: Plan) -> None:
    """The middle, seen across the desks."""
    plan.block(
        (4.7, 3.3, 0), (0.34, 3.3, 1.25), wood(OAK), 200, west=book_case(OAK), east=book_case(OAK), up=desk_top(OAK)
    )
    plan.block((4.72, 3.6, 1.25), (0.3, 0.4, 0.3), cardboard, 220)
    plan.block((4.75, 5.5, 1.25), (0.25, 0.6, 0.35), leaves, 200)
    plan.panel("north", (5.2, 2.75 + _GAP, 0.85), (2.4, 1.3), white_board, 220)
    plan.panel("north", (7.9, 2.75 + _GAP, 0.9), (1.1, 1.2), cork_board, 240)
    plan.panel("west", (9.3 - _GAP, 3.2, 0.9), (1.6, 1.2), white_board, 220)
    plan.block((6.2, 4.2, 0.70), (2.0, 1.2, 0.05), wood(OAK), up=desk_top(OAK))
    plan.block((6.9, 4.6, 0), (0.6, 0.4, 0.70), wood(BLACKENED))
    plan.panel("south", (5.4, 6.95 - _GAP, 0.5), (0.8, 1.1), art(6), 200)
    plan.panel("south", (6.8, 6.95 - _GAP, 0.5), (1.4, 1.0), art(1), 200)
    plan.block((8.3, 5.9, 0), (0.5, 0.5, 0.5), cardboard, 220)
    plan.block((8.35, 5.95, 0.5), (0.4, 0.4, 0.35), cardboard, 220)
    plan.block((5.6, 5.9, 0), (0.35, 0.35, HEIGHT), plaster(MUSTARD), south=sign("B2", NAVY), west=art(5), north=art(0))
