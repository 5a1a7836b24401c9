"""The box of the Maxar-1300: its panels, and the blankets on all six faces.

The ring stands 0.15 m proud of the box, so the box fills z from -0.15 to -3.75 m.
"""

from __future__ import annotations

import numpy as np
import trimesh

from models.pose import RigidTransform
from models.spacecraft.mli_blanket import Blanket
from models.spacecraft.part import Part
from models.spacecraft.retroreflector_layout import RETROREFLECTORS
from models.spacecraft.solids import box, holed_square, joined, placed, standing

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

Line = tuple[tuple[float, float], tuple[float, float]]


def bus_parts() -> tuple[Part, ...]:
    """Return the panels, the blankets and their tape."""
    blankets = _blankets()
    return (
        Part("bus_structure", _structure(), "bare_aluminium"),
        Part("mli_blanket", joined(placed(b.foil(), at) for b, at in blankets), "mli_gold"),
        Part(
            "mli_tape",
            joined(placed(b.tape(), at) for b, at in blankets if b.seams),
            "mli_aluminium",
        ),
    )


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


def _blankets() -> list[tuple[Blanket, RigidTransform]]:
    return [(_ring_side(), RigidTransform(np.eye(3), np.array([0.0, 0.0, FACE_Z_M]))), *_sides()]


def _ring_side() -> Blanket:
    """Return the blanket round the ring, seamed from the ring to the corners and edges."""
    reach = 0.45 * HALF_M
    seams: list[Line] = []
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            seams.append(((0.63 * sx, 0.63 * sy), (HALF_M * sx, HALF_M * sy)))
            seams.append(((reach * sx, 0.70 * sy), (reach * sx, HALF_M * sy)))
            seams.append(((0.70 * sx, reach * sy), (HALF_M * sx, reach * sy)))
    return Blanket(
        low=(-HALF_M, -HALF_M),
        high=(HALF_M, HALF_M),
        facet_m=0.022,
        seed=1300,
        seams=tuple(seams),
        hole=(0.0, 0.0, RING_CUTOUT_M),
        held_flat=tuple((x, y, 0.06) for x, y, _ in RETROREFLECTORS.points_in_target),
    )


def _sides() -> list[tuple[Blanket, RigidTransform]]:
    """Return the blankets of the other five faces; those of +-y frame the radiators."""
    half, half_length = HALF_M, 0.5 * LENGTH_M
    middle = (0.0, 0.0, FACE_Z_M - half_length)
    across: list[Line] = [((-half, z), (half, z)) for z in (-0.6, 0.6)]
    along: list[Line] = [((0.0, -half_length), (0.0, half_length))]
    deck: list[Line] = [((x, -half), (x, half)) for x in (-0.4, 0.4)]
    placings = []
    for sign in (-1.0, 1.0):
        whole = Blanket((-half, -half_length), (half, half_length), 0.065, 40, (*across, *along))
        at = standing((sign * half, 0.0, middle[2]), (sign, 0.0, 0.0), (0.0, sign, 0.0))
        placings.append((whole, at))
        at = standing((0.0, sign * half, middle[2]), (0.0, sign, 0.0), (-sign, 0.0, 0.0))
        placings += [(strip, at) for strip in _radiator_frame()]
    earth = Blanket((-half, -half), (half, half), 0.075, 50, tuple(deck))
    placings.append((earth, standing((0.0, 0.0, EARTH_FACE_Z_M), (0.0, 0.0, -1.0))))
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
        Blanket(low, high, 0.06, 60 + k, relief_m=0.01) for k, (low, high) in enumerate(rectangles)
    ]
