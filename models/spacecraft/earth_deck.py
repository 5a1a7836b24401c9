"""The Earth deck, on -z opposite the ring: horns, a steerable dish and the telemetry tower."""

from __future__ import annotations

import numpy as np
import trimesh

from models.arrays import Floats
from models.pose import RigidTransform
from models.spacecraft.bus import EARTH_FACE_Z_M
from models.spacecraft.part import Part
from models.spacecraft.solids import (
    bar,
    box,
    cup,
    cylinder,
    joined,
    lathe,
    placed,
    shifted,
    standing,
    tube,
)

HORNS = ((-0.55, 0.62, 0.16, 0.55), (0.55, 0.62, 0.16, 0.55), (-0.62, -0.55, 0.10, 0.38))
TOWER_M = 1.05
TOWER_FOOT_M = (-0.15, -0.25)
TOWER_HALF_M = (0.16, 0.07)  # at foot and top
LEG_M = 0.022
DISH_RADIUS_M, DISH_FOCAL_LENGTH_M = 0.36, 0.26
DECK = standing((0.0, 0.0, EARTH_FACE_Z_M), (0.0, 0.0, -1.0))  # target from deck


def earth_deck_parts() -> tuple[Part, ...]:
    """Return the deck's antennas; their own z axis points to Earth."""
    pieces = (
        ("earth_deck", _horns(), "bare_aluminium", True),
        ("earth_deck", _boxes(), "white_paint", False),
        ("steerable_antenna", _dish(), "white_paint", True),
        ("steerable_antenna", _gimbal(), "anodised_aluminium", False),
        ("telemetry_tower", _tower(), "carbon_fibre", False),
        ("telemetry_tower", _helices(), "bare_aluminium", True),
    )
    return tuple(
        Part(name, placed(mesh, DECK), material, smooth) for name, mesh, material, smooth in pieces
    )


def _horns() -> trimesh.Trimesh:
    """Return the global-coverage horns."""
    return joined(
        placed(
            joined(
                [
                    cup(0.3 * mouth, mouth, 0.25 * tall, tall, 0.005, 40),
                    cylinder(0.28 * mouth, -0.01, 0.25 * tall, 24),
                ]
            ),
            RigidTransform(np.eye(3), np.array([x, y, 0.0])),
        )
        for x, y, mouth, tall in HORNS
    )


def _boxes() -> trimesh.Trimesh:
    """Return the Earth sensors and the receivers on the deck."""
    return joined(
        [
            box((0.22, 0.18, 0.16), (0.0, 0.72, 0.08)),
            box((0.16, 0.16, 0.14), (-0.15, -0.86, 0.07)),
            box((0.16, 0.16, 0.14), (0.10, -0.86, 0.07)),
            box((0.40, 0.30, 0.07), (0.10, 0.15, 0.035)),
        ]
    )


def deck_from_dish() -> RigidTransform:
    """Return where the steerable dish stands: its vertex, z along its axis."""
    return standing((0.62, -0.50, 0.42), (0.35, -0.25, 1.0))


def _dish() -> trimesh.Trimesh:
    """Return a small front-fed dish with its subreflector."""
    r = np.linspace(0.0, DISH_RADIUS_M, 12)
    face = np.column_stack([r, r**2 / (4.0 * DISH_FOCAL_LENGTH_M)])
    back = face - np.array([0.0, 0.012])
    shell = lathe([*back.tolist(), *face[::-1].tolist()], 48)
    return placed(joined([shell, cylinder(0.05, 0.24, 0.27, 20)]), deck_from_dish())


def _gimbal() -> trimesh.Trimesh:
    frame = deck_from_dish()
    base = frame @ np.array([0.0, 0.0, -0.01])
    legs = []
    for turn in np.deg2rad([90.0, 210.0, 330.0]):
        edge = np.array([0.25 * np.cos(turn), 0.25 * np.sin(turn), 0.06])
        legs.append(bar(frame @ edge, frame @ np.array([0.0, 0.0, 0.25]), 0.012, 0.012))
    return joined(
        [
            bar((0.62, -0.50, -0.01), base, 0.10, 0.10),
            box((0.24, 0.24, 0.10), (0.62, -0.50, 0.05)),
            *legs,
        ]
    )


def tower_legs() -> tuple[Floats, Floats]:
    """Return the middles of the tower's legs at its foot and at its top, (4, 3) m each, on deck."""
    low, high = TOWER_HALF_M
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float)
    foot = np.array([*TOWER_FOOT_M, 0.0])
    feet = np.column_stack([low * corners, np.zeros(4)]) + foot
    tops = np.column_stack([high * corners, np.full(4, TOWER_M)]) + foot
    return feet, tops


def _tower() -> trimesh.Trimesh:
    """Return the four-legged truss of the telemetry antennas."""
    feet, tops = tower_legs()
    bars = [bar(feet[k], tops[k], LEG_M, LEG_M) for k in range(4)]
    for level in (0.33, 0.66, 1.0):
        ring = feet + level * (tops - feet)
        bars += [bar(ring[k], ring[(k + 1) % 4], 0.018, 0.018) for k in range(4)]
        lower = feet + (level - 0.33) * (tops - feet)
        bars += [bar(lower[k], ring[(k + 1) % 4], 0.012, 0.012) for k in range(4)]
    return joined([*bars, box((0.20, 0.20, 0.02), (*TOWER_FOOT_M, TOWER_M))])


def _helices() -> trimesh.Trimesh:
    """Return a helix and a bicone on the tower's top."""
    t = np.linspace(0.0, 6.0 * 2.0 * np.pi, 73)
    helix = np.column_stack(
        [0.035 * np.cos(t), 0.035 * np.sin(t), TOWER_M + 0.02 + 0.34 * t / t[-1]]
    )
    bicone = lathe([(0.0, 0.0), (0.07, 0.0), (0.015, 0.06), (0.07, 0.12), (0.0, 0.12)], 28)
    return joined(
        [
            shifted(tube(helix, 0.005, 5), (-0.19, -0.21, 0.0)),
            shifted(bicone, (-0.10, -0.30, TOWER_M + 0.01)),
        ]
    )
