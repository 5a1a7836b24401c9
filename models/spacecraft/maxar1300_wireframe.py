"""The Maxar-1300's wireframe: 26 corners that an image shows, and a hull that hides them.

Wing corners lie in the middle of the sheet's thickness. Half a turn about z carries body,
radiators, wings and reflectors onto themselves, to the last digit; half a turn about x or y carries
the wings and, to 0.3 m, the body, while the reflectors would look the other way. What tells the
first from the truth stands on the Earth deck alone: the telemetry tower, one leg of which is an
edge to look for, and horns and a dish, which hide and shine.
"""

from __future__ import annotations

import numpy as np
import trimesh

from models.arrays import Floats
from models.pose import RigidTransform
from models.spacecraft import bus, earth_deck
from models.spacecraft.hull import (
    Outline,
    box_outline,
    dish_outline,
    hiding,
    sheet_outline,
    wireframe,
)
from models.spacecraft.launch_adaptor_ring import RADIUS_M as RING_RADIUS_M
from models.spacecraft.maxar1300 import CENTRE_OF_MASS_M
from models.spacecraft.maxar1300_unmarked import NAME
from models.spacecraft.offset_reflector import DISH
from models.spacecraft.radiator import PANEL_PROUD_M
from models.spacecraft.solar_wing import WING, WING_Z_M
from models.spacecraft.solids import bar, lathe, placed
from models.wireframe.wireframe import Wireframe

SIDES = {"plus_y": 1.0, "minus_y": -1.0}
FROM_RING = RigidTransform(np.eye(3), -np.array(CENTRE_OF_MASS_M))  # from TGFF
RING_SIDES, HORN_SIDES, DISH_RINGS, DISH_SPOKES = 16, 8, 3, 8
LEG = 0  # of the tower's, the one whose outer edge is looked for


def maxar1300_wireframe() -> Wireframe:
    """Build the wireframe from the dimensions of the mesh."""
    half = bus.HALF_M
    body = box_outline("body", (-half, -half, bus.EARTH_FACE_Z_M), (half, half, bus.FACE_Z_M))
    outlines = [*_wings(), body, *_radiators(), _tower(), *_hidden()]
    return wireframe(NAME, [_at_centre_of_mass(each) for each in outlines])


def wing_corners(sign: float) -> Floats:
    """Return a wing's corners in TGFF, inner minus x first, then round by its tip, (4, 3) m."""
    x = 0.5 * WING.panel_m[0] * np.array([-1.0, -1.0, 1.0, 1.0])
    y = sign * np.array([WING.inner_m, WING.tip_m, WING.tip_m, WING.inner_m])
    return np.column_stack([x, y, np.full(4, WING_Z_M - 0.5 * WING.thickness_m)])


def _wings() -> list[Outline]:
    ends = ("inner_minus_x", "tip_minus_x", "tip_plus_x", "inner_plus_x")
    return [
        sheet_outline(
            f"wing_{side}", tuple(f"wing_{side}_{end}" for end in ends), wing_corners(sign)
        )
        for side, sign in SIDES.items()
    ]


def _radiators() -> list[Outline]:
    """Return the radiators' faces: mirrors in a frame of foil."""
    across, along = 0.5 * bus.RADIATOR_SIZE_M[0], 0.5 * bus.RADIATOR_SIZE_M[1]
    ends = ("minus_x_low", "minus_x_high", "plus_x_high", "plus_x_low")
    x = across * np.array([-1.0, -1.0, 1.0, 1.0])
    z = bus.RADIATOR_CENTRE_Z_M + along * np.array([-1.0, 1.0, 1.0, -1.0])
    return [
        sheet_outline(
            f"radiator_{side}",
            tuple(f"radiator_{side}_{end}" for end in ends),
            np.column_stack([x, np.full(4, sign * (bus.HALF_M + PANEL_PROUD_M)), z]),
        )
        for side, sign in SIDES.items()
    ]


def _tower() -> Outline:
    """Return the telemetry tower: a truss, taken for a solid, and the outer edge of one leg."""
    feet, tops = earth_deck.tower_legs()
    solid = trimesh.Trimesh(np.concatenate([feet, tops])).convex_hull
    leg = bar(feet[LEG], tops[LEG], earth_deck.LEG_M, earth_deck.LEG_M)
    middle = feet.mean(axis=0)[:2]
    ends = []
    for end in (feet[LEG], tops[LEG]):
        near = leg.vertices[np.abs(leg.vertices[:, 2] - end[2]) < earth_deck.LEG_M]
        ends.append(near[np.linalg.norm(near[:, :2] - middle, axis=1).argmax()])
    points = earth_deck.DECK @ np.array(ends)
    triangles = np.asarray(placed(solid, earth_deck.DECK).triangles, dtype=np.float64)
    return Outline("tower", ("tower_foot", "tower_top"), points, ((0, 1),), triangles)


def _hidden() -> list[Outline]:
    """Return what only hides: ring, reflectors, and what stands on the Earth deck."""
    turns = (np.diag([sign, sign, 1.0]) for sign in (1.0, -1.0))
    ring = _round((0.0, 0.0), RING_RADIUS_M, RING_RADIUS_M, bus.FACE_Z_M, 0.0, RING_SIDES)
    horns = [
        placed(_round((x, y), 0.3 * mouth, mouth, 0.0, tall, HORN_SIDES), earth_deck.DECK)
        for x, y, mouth, tall in earth_deck.HORNS
    ]
    r = np.linspace(0.0, earth_deck.DISH_RADIUS_M, DISH_RINGS)
    face = np.column_stack([r, r**2 / (4.0 * earth_deck.DISH_FOCAL_LENGTH_M)])
    steerable = placed(
        placed(lathe(face, DISH_SPOKES), earth_deck.deck_from_dish()), earth_deck.DECK
    )
    return [
        *(dish_outline(DISH, RigidTransform(turn, np.zeros(3))) for turn in turns),
        *(hiding(solid) for solid in (ring, *horns, steerable)),
    ]


def _round(
    at: tuple[float, float], low_m: float, high_m: float, low_z: float, high_z: float, sides: int
) -> trimesh.Trimesh:
    """Return an open cone or cylinder along z, of the circle's width on average."""
    swell = 1.0 / np.sinc(1.0 / sides)
    wall = lathe([(swell * low_m, low_z), (swell * high_m, high_z)], sides)
    return placed(wall, RigidTransform(np.eye(3), np.array([*at, 0.0])))


def _at_centre_of_mass(outline: Outline) -> Outline:
    points = outline.points if not len(outline.points) else FROM_RING @ outline.points
    triangles = (FROM_RING @ outline.triangles.reshape(-1, 3)).reshape(-1, 3, 3)
    return Outline(outline.component, outline.names, points, outline.edges, triangles)
