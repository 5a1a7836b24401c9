"""The 22 N thrusters: three to a cluster, a cluster in each corner of the ring's side."""

from __future__ import annotations

import numpy as np
import trimesh

from models.arrays import Floats
from models.spacecraft.bus import FACE_Z_M, HALF_M
from models.spacecraft.part import Part
from models.spacecraft.solids import (
    box,
    cylinder,
    hexagon,
    joined,
    lathe,
    placed,
    prism,
    shifted,
    standing,
)

EXIT_RADIUS_M = 0.024
THROAT_RADIUS_M = 0.003
BELL_M = 0.062
CHAMBER_M = 0.026
CLUSTER_INSET_M = 0.14  # from the bus's edges


def thruster_parts() -> tuple[Part, ...]:
    """Return the nozzles, and the blocks and valves that carry them."""
    nozzles, mounts = [], []
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            corner = np.array(
                [sx * (HALF_M - CLUSTER_INSET_M), sy * (HALF_M - CLUSTER_INSET_M), FACE_Z_M]
            )
            mounts.append(_mount(corner))
            for offset, direction in _directions(sx, sy):
                at = standing(corner + offset, direction)
                nozzles.append(placed(nozzle(), at))
                mounts.append(placed(_valve(), at))
    return (
        Part("thrusters", joined(nozzles), "titanium_nozzle", smooth=True),
        Part("thruster_mounts", joined(mounts), "anodised_aluminium"),
    )


def _directions(sx: float, sy: float) -> list[tuple[Floats, Floats]]:
    """Return each thruster's throat, from the cluster's foot, and its exhaust direction."""
    return [
        (np.array([0.0, 0.0, 0.058]), np.array([0.0, 0.0, 1.0])),
        (np.array([0.075 * sx, -0.015 * sy, 0.052]), np.array([sx, 0.0, 0.45])),
        (np.array([-0.015 * sx, 0.075 * sy, 0.052]), np.array([0.0, sy, 0.45])),
    ]


def nozzle() -> trimesh.Trimesh:
    """Return one nozzle with its chamber: throat at the origin, exhaust along +z."""
    t = np.linspace(0.0, 1.0, 7)
    bell = np.column_stack(
        [
            THROAT_RADIUS_M + (EXIT_RADIUS_M - THROAT_RADIUS_M) * np.sqrt(t) * (0.55 + 0.45 * t),
            BELL_M * t,
        ]
    )
    wall = 0.0012
    return lathe(
        [
            (0.0, -CHAMBER_M),
            (0.0085, -CHAMBER_M),
            (0.0085, -0.006),
            *(bell + np.array([wall, 0.0])).tolist(),
            *bell[::-1].tolist(),
            (0.0, -0.004),
        ],
        20,
    )


def _valve() -> trimesh.Trimesh:
    """Return the flange and the two valves behind a chamber."""
    back = -CHAMBER_M
    return joined(
        [
            prism(hexagon(0.036), back - 0.006, back),
            shifted(cylinder(0.009, back - 0.030, back - 0.006, 12), (0.010, 0.0, 0.0)),
            shifted(cylinder(0.009, back - 0.030, back - 0.006, 12), (-0.010, 0.0, 0.0)),
        ]
    )


def _mount(corner: Floats) -> trimesh.Trimesh:
    """Return the block of a cluster, standing on the blanket."""
    return joined(
        [
            shifted(box((0.15, 0.15, 0.008), (0.0, 0.0, 0.007)), corner),
            shifted(box((0.085, 0.085, 0.018), (0.0, 0.0, 0.018)), corner),
        ]
    )
