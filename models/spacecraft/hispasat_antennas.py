"""Hispasat 36W-1's antennas: two deployed reflectors with feeds, and what stands on the Earth deck.

Beams point at the Earth, along +z. The active receiving antenna is a box whose top is its aperture.
"""

from __future__ import annotations

import numpy as np
import trimesh

from models.pose import RigidTransform
from models.spacecraft import hispasat_layout as at
from models.spacecraft.offset_reflector import feed_frame, feed_horn
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

DECK_Z = at.BODY_HIGH[2]
SIDES = {"plus_x": 1.0, "minus_x": -1.0}


def antenna_parts() -> tuple[Part, ...]:
    """Return reflectors, arms and feeds of both sides, and the deck's antennas."""
    parts: list[Part] = []
    for side, sign in SIDES.items():
        turn = at.body_from_dish(sign)
        pieces = (
            ("reflector", at.DISH.face(), "white_paint", True),
            ("reflector", at.DISH.back(), "carbon_fibre", True),
            ("reflector", at.DISH.ribs(), "carbon_fibre", False),
            ("reflector_arm", _arm(), "carbon_fibre", False),
            ("reflector_arm", _hinge(), "anodised_aluminium", False),
            ("feed", feed_horn(at.DISH), "bare_aluminium", True),
            ("feed", _feed_bracket(), "white_paint", False),
        )
        parts += [
            Part(f"{name}_{side}", placed(mesh, turn), material, smooth)
            for name, mesh, material, smooth in pieces
        ]
    return (
        *parts,
        Part("active_antenna", _active_antenna(), "white_paint"),
        Part("earth_deck", _deck_boxes(), "anodised_aluminium"),
        Part("earth_deck", _horns(), "bare_aluminium", smooth=True),
    )


def _arm() -> trimesh.Trimesh:
    """Return the two struts from the hinge to the hub, in the dish's frame."""
    elbow = np.array([at.BODY_HIGH[0] + 0.14, 0.0, at.DISH.vertex_z_m + 0.34])
    aside = np.array([0.0, 1.0, 0.0])
    hub = at.DISH.hub()
    struts = [
        bar(elbow + 0.26 * s * aside, hub + 0.09 * s * aside, 0.05, 0.05) for s in (-1.0, 1.0)
    ]
    return joined([*struts, bar(elbow - 0.32 * aside, elbow + 0.32 * aside, 0.06, 0.06)])


def _hinge() -> trimesh.Trimesh:
    x, z = at.BODY_HIGH[0] + 0.08, at.DISH.vertex_z_m + 0.34
    return joined(box((0.18, 0.10, 0.12), (x, y, z)) for y in (-0.26, 0.26))


def _feed_bracket() -> trimesh.Trimesh:
    """Return the bracket over the Earth deck's edge that carries the horn, in the dish's frame."""
    at_feed = feed_frame(at.DISH)
    back = at_feed @ np.array([0.0, 0.0, -0.46])
    plate = placed(box((0.16, 0.20, 0.05), (0.0, 0.0, -0.40)), at_feed)
    edge = at.BODY_HIGH[0] - 0.10
    legs = [
        bar((edge, y, -DECK_Z), back + np.array([0.0, 0.4 * y, 0.0]), 0.045, 0.045)
        for y in (-0.20, 0.20)
    ]
    return joined([plate, *legs, bar((edge - 0.35, 0.0, -DECK_Z), back, 0.045, 0.045)])


def _active_antenna() -> trimesh.Trimesh:
    low, high = np.array(at.ACTIVE_LOW), np.array(at.ACTIVE_HIGH)
    return box(high - low, 0.5 * (low + high))


def _deck_boxes() -> trimesh.Trimesh:
    """Return the Earth sensors and the telemetry mast."""
    return joined(
        [
            box((0.20, 0.16, 0.14), (0.60, 0.62, DECK_Z + 0.07)),
            box((0.16, 0.16, 0.12), (0.30, -0.72, DECK_Z + 0.06)),
            bar((-0.20, -0.55, DECK_Z - 0.01), (-0.20, -0.55, DECK_Z + 0.75), 0.05, 0.05),
        ]
    )


def _horns() -> trimesh.Trimesh:
    """Return two global horns and the telemetry antenna on its mast."""
    upright = [
        RigidTransform(np.eye(3), np.array([x, y, DECK_Z])) for x, y in ((0.55, -0.40), (0.62, 0.2))
    ]
    horn = joined([cup(0.05, 0.13, 0.12, 0.42, 0.005, 40), cylinder(0.045, -0.01, 0.12, 24)])
    bicone = lathe([(0.0, 0.0), (0.07, 0.0), (0.015, 0.06), (0.07, 0.12), (0.0, 0.12)], 28)
    mast = standing((-0.20, -0.55, DECK_Z + 0.75), (0.0, 0.0, 1.0))
    return joined([*(placed(horn, place) for place in upright), placed(bicone, mast)])
