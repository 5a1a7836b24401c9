"""The box of the Maxar-1300: its panels, and the blankets on all six faces.

The ring stands 0.15 m proud of the box, so the box fills z from -0.15 to -3.75 m. Film faces
outward on most of it, which looks gold; the frames round the radiators and the Earth deck are of
foil with its metal outward. Seams and edges are bound with aluminium tape, and buttons hold the
blankets to the panels.
"""

from __future__ import annotations

import numpy as np
import trimesh

from models.pose import RigidTransform
from models.spacecraft.mli_blanket import TAPE_WIDTH_M, Blanket, Circle, Line
from models.spacecraft.part import Part
from models.spacecraft.retroreflector_layout import RETROREFLECTORS
from models.spacecraft.solids import box, cylinder, holed_square, joined, placed, shifted, standing

WIDTH_M = 2.4  # x and y, Opromolla et al. 2022, Figure 2 is not at hand: a 1300 bus is 2.4 m wide
LENGTH_M = 3.6  # z
FACE_Z_M = -0.15  # the blanket's held-down level on the ring's side
EARTH_FACE_Z_M = FACE_Z_M - LENGTH_M
HALF_M = 0.5 * WIDTH_M
BLANKET_M = 0.012  # thickness of the held-down blanket: the panels lie this far inside
RING_CUTOUT_M = 0.872
ENGINE_WELL_M = 0.21
PANEL_M = 0.025  # aluminium honeycomb
RADIATOR_SIZE_M = (1.96, 2.9)  # x and z, on both y faces
RADIATOR_CENTRE_Z_M = FACE_Z_M - 0.5 * LENGTH_M

RELIEF_M = 0.018  # of the creases on the ring's side, which fittings stand on
SIDE_RELIEF_M = 0.030  # of the wider creases on the other sides
BUTTON_RADIUS_M = 0.011  # of the washers that clip a blanket to its panel
BUTTON_M = 0.004
FOIL, METAL = "mli_gold", "mli_aluminium"


def bus_parts() -> tuple[Part, ...]:
    """Return the panels, the blankets, their tape and their buttons."""
    placings = blankets()
    foils = {blanket: blanket.foil() for blanket in {b for b, _, _ in placings}}
    tape = joined(placed(blanket.tape(), at) for blanket, at, _ in placings)
    buttons = joined(
        placed(_buttons(blanket), at) for blanket, at, _ in placings if blanket.buttons
    )
    return (
        Part("bus_structure", _structure(), "bare_aluminium"),
        *(
            Part(
                "mli_blanket",
                joined(placed(foils[b], at) for b, at, outer in placings if outer == material),
                material,
                smooth=True,
            )
            for material in (FOIL, METAL)
        ),
        Part("mli_tape", tape, METAL),
        Part("mli_buttons", buttons, "black_paint"),
    )


def _buttons(blanket: Blanket) -> trimesh.Trimesh:
    button = cylinder(BUTTON_RADIUS_M, 0.0, BUTTON_M, 12)
    return joined(shifted(button, (x, y, 0.0)) for x, y, _ in blanket.buttons)


def _structure() -> trimesh.Trimesh:
    """Return the six panels; the one under the ring has the engine's well in it."""
    half, top, bottom = HALF_M - BLANKET_M, FACE_Z_M - BLANKET_M, EARTH_FACE_Z_M + BLANKET_M
    t = PANEL_M
    height, middle = top - bottom - 2.0 * t, 0.5 * (top + bottom)
    walls = [
        box((t, 2.0 * half, height), (side * (half - 0.5 * t), 0.0, middle)) for side in (-1, 1)
    ] + [
        box((2.0 * (half - t), t, height), (0.0, side * (half - 0.5 * t), middle))
        for side in (-1, 1)
    ]
    floor = box((2.0 * half, 2.0 * half, t), (0.0, 0.0, bottom + 0.5 * t))
    return joined([holed_square(half, ENGINE_WELL_M, top - t, top, 64), floor, *walls])


def blankets() -> list[tuple[Blanket, RigidTransform, str]]:
    """Return every blanket, its place and the material of its outer face."""
    ring_side = RigidTransform(np.eye(3), np.array([0.0, 0.0, FACE_Z_M]))
    return [(_ring_side(), ring_side, FOIL), *_sides()]


def _ring_side() -> Blanket:
    """Return the blanket round the ring, seamed from the ring to the corners and edges."""
    reach = 0.45 * HALF_M
    low, high = (-HALF_M, -HALF_M), (HALF_M, HALF_M)
    seams: list[Line] = [*bound_edges(low, high)]
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            seams.append(((0.63 * sx, 0.63 * sy), (HALF_M * sx, HALF_M * sy)))
            seams.append(((reach * sx, 0.70 * sy), (reach * sx, HALF_M * sy)))
            seams.append(((0.70 * sx, reach * sy), (HALF_M * sx, reach * sy)))
    return Blanket(
        low=low,
        high=high,
        facet_m=0.013,
        seed=1300,
        seams=tuple(seams),
        relief_m=RELIEF_M,
        hole=(0.0, 0.0, RING_CUTOUT_M),
        held_flat=tuple((x, y, 0.06) for x, y, _ in RETROREFLECTORS.points_in_target),
        buttons=tuple(
            (sx * x, sy * y, BUTTON_RADIUS_M)
            for sx in (-1.0, 1.0)
            for sy in (-1.0, 1.0)
            for x, y in ((0.30, 1.02), (1.02, 0.30), (0.80, 1.00), (1.00, 0.80))
        ),
    )


def bound_edges(low: tuple[float, float], high: tuple[float, float]) -> tuple[Line, ...]:
    """Return the middles of the tape along a rectangle's four edges, m."""
    (x0, y0), (x1, y1) = low, high
    t = 0.5 * TAPE_WIDTH_M
    return (
        ((x0, y0 + t), (x1, y0 + t)),
        ((x0, y1 - t), (x1, y1 - t)),
        ((x0 + t, y0), (x0 + t, y1)),
        ((x1 - t, y0), (x1 - t, y1)),
    )


def _side(half: float, half_length: float, facet_m: float, seed: int, seams: list[Line]) -> Blanket:
    """Return the blanket of a whole face, its buttons in rows between the seams."""
    low, high = (-half, -half_length), (half, half_length)
    rows = np.arange(-half_length + 0.30, half_length, 0.60)
    columns = np.arange(-half + 0.30, half, 0.60)
    buttons: tuple[Circle, ...] = tuple(
        (float(x), float(y), BUTTON_RADIUS_M) for x in columns for y in rows
    )
    edges = bound_edges(low, high)
    return Blanket(
        low, high, facet_m, seed, (*edges, *seams), buttons=buttons, relief_m=SIDE_RELIEF_M
    )


def _sides() -> list[tuple[Blanket, RigidTransform, str]]:
    """Return the blankets of the other five faces; those of +-y frame the radiators."""
    half, half_length = HALF_M, 0.5 * LENGTH_M
    middle = (0.0, 0.0, FACE_Z_M - half_length)
    across: list[Line] = [((-half, z), (half, z)) for z in (-0.6, 0.6)]
    along: list[Line] = [((0.0, -half_length), (0.0, half_length))]
    deck: list[Line] = [((x, -half), (x, half)) for x in (-0.4, 0.4)]
    placings = []
    for sign in (-1.0, 1.0):
        whole = _side(half, half_length, 0.035, 40, [*across, *along])
        at = standing((sign * half, 0.0, middle[2]), (sign, 0.0, 0.0), (0.0, sign, 0.0))
        placings.append((whole, at, FOIL))
        at = standing((0.0, sign * half, middle[2]), (0.0, sign, 0.0), (-sign, 0.0, 0.0))
        placings += [(strip, at, METAL) for strip in _radiator_frame()]
    earth = standing((0.0, 0.0, EARTH_FACE_Z_M), (0.0, 0.0, -1.0))
    placings.append((_side(half, half, 0.040, 50, deck), earth, METAL))
    return placings


def _radiator_frame() -> list[Blanket]:
    """Return four strips of blanket round a radiator."""
    x, z = 0.5 * RADIATOR_SIZE_M[0], 0.5 * RADIATOR_SIZE_M[1]
    half, half_length = HALF_M, 0.5 * LENGTH_M
    rectangles = [
        ((-half, -half_length), (-x, half_length)),
        ((x, -half_length), (half, half_length)),
        ((-x, -half_length), (x, -z)),
        ((-x, z), (x, half_length)),
    ]
    return [
        Blanket(low, high, 0.03, 60 + k, bound_edges(low, high), relief_m=0.020)
        for k, (low, high) in enumerate(rectangles)
    ]
