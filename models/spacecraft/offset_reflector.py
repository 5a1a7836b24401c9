"""A deployed communication reflector on +-x: an offset paraboloid, its arm, and its feed.

Both beams point at Earth, along -z. The parent paraboloid's axis runs beside the bus; the feed
horn at its focus, over the Earth deck's edge, looks back at the dish.
"""

from __future__ import annotations

import numpy as np
import trimesh

from models.pose import RigidTransform
from models.spacecraft.bus import EARTH_FACE_Z_M, HALF_M
from models.spacecraft.offset_dish import OffsetDish
from models.spacecraft.part import Part
from models.spacecraft.solids import (
    bar,
    box,
    cup,
    cylinder,
    joined,
    lathe,
    placed,
    standing,
)

DIAMETER_M = 2.2
SHELL_M = 0.022
VERTEX_Z_M = -2.0
DISH = OffsetDish(
    diameter_m=DIAMETER_M,
    focal_length_m=1.9,
    axis_x_m=1.32,
    vertex_z_m=VERTEX_Z_M,
    clearance_m=0.35,
    shell_m=SHELL_M,
)


def offset_reflector_parts(sign: float) -> tuple[Part, ...]:
    """Return dish, arm and feed on the +x (``sign`` 1) or -x (-1) side."""
    side = "plus_x" if sign > 0.0 else "minus_x"
    turn = RigidTransform(np.diag([sign, sign, 1.0]), np.zeros(3))  # half a turn about z, or none
    pieces = (
        ("reflector", DISH.face(), "white_paint", True),
        ("reflector", DISH.back(), "carbon_fibre", True),
        ("reflector", DISH.ribs(), "carbon_fibre", False),
        ("reflector_arm", _arm(), "carbon_fibre", False),
        ("reflector_arm", _hinge(), "anodised_aluminium", False),
        ("feed", feed_horn(DISH), "bare_aluminium", True),
        ("feed", _feed_bracket(), "white_paint", False),
    )
    return tuple(
        Part(f"{name}_{side}", placed(mesh, turn), material, smooth)
        for name, mesh, material, smooth in pieces
    )


def _arm() -> trimesh.Trimesh:
    """Return the two struts from the bus's hinge to the hub on the dish's back."""
    hub = DISH.hub()
    elbow = np.array([HALF_M + 0.16, 0.0, VERTEX_Z_M + 0.34])
    aside = np.array([0.0, 1.0, 0.0])
    struts = [
        bar(elbow + 0.28 * sy * aside, hub + 0.09 * sy * aside, 0.06, 0.06) for sy in (-1.0, 1.0)
    ]
    return joined([*struts, bar(elbow - 0.34 * aside, elbow + 0.34 * aside, 0.07, 0.07)])


def _hinge() -> trimesh.Trimesh:
    """Return the hinges on the bus's side."""
    z = VERTEX_Z_M + 0.34
    return joined(box((0.20, 0.10, 0.13), (HALF_M + 0.09, y, z)) for y in (-0.28, 0.28))


def feed_frame(dish: OffsetDish) -> RigidTransform:
    """Return the pose of a dish's feed: mouth at the focus, z towards the dish's middle."""
    return standing(dish.focus, dish.centre() - dish.focus)


def feed_horn(dish: OffsetDish) -> trimesh.Trimesh:
    """Return the corrugated feed horn, mouth at the focus, and its waveguide."""
    horn = joined(
        [
            cup(0.045, 0.115, -0.34, 0.0, 0.006, 40),
            cylinder(0.040, -0.52, -0.34, 24),
            *(
                lathe(_flange(r, z), 40)
                for r, z in ((0.075, -0.20), (0.098, -0.09), (0.121, -0.006))
            ),
        ]
    )
    return placed(horn, feed_frame(dish))


def _flange(radius_m: float, z_m: float) -> list[tuple[float, float]]:
    inner, half = radius_m - 0.012, 0.004
    return [
        (inner, z_m - half),
        (radius_m, z_m - half),
        (radius_m, z_m + half),
        (inner, z_m + half),
        (inner, z_m - half),
    ]


def _feed_bracket() -> trimesh.Trimesh:
    """Return the tower over the Earth deck's edge that carries the horn."""
    at = feed_frame(DISH)
    back = at @ np.array([0.0, 0.0, -0.46])
    return joined(
        [
            placed(box((0.16, 0.20, 0.05), (0.0, 0.0, -0.40)), at),
            *(
                bar(
                    (HALF_M - 0.12, y, EARTH_FACE_Z_M),
                    back + np.array([0.0, 0.4 * y, 0.0]),
                    0.05,
                    0.05,
                )
                for y in (-0.22, 0.22)
            ),
            bar((HALF_M - 0.5, 0.0, EARTH_FACE_Z_M), back, 0.05, 0.05),
        ]
    )
