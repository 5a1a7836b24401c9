"""The launch adaptor ring: the interface by which the launcher held the satellite.

A 1666 mm clamp-band interface: a stiff flange at the separation plane (z = 0), whose chamfered
lip the clamp band gripped, a thin wall, and a foot bolted to the bus. Inside and outside the wall
stand gussets; round it the separation springs' pads and the umbilical connectors' brackets.
"""

from __future__ import annotations

import numpy as np
import trimesh

from models.pose import RigidTransform
from models.spacecraft.bus import FACE_Z_M
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
)

RADIUS_M = 0.83  # of the flange's outer edge; Opromolla et al. 2022: 0.83 m to the grasping point
FLANGE_WIDTH_M = 0.028
LIP_M = 0.006  # height of the flange's outer edge, above the chamfer
WALL_RADIUS_M = 0.812
WALL_M = 0.005
FOOT_OUTER_M = 0.866
FOOT_INNER_M = 0.775
FOOT_M = 0.008
SEGMENTS = 192
BOLTS = 72
GUSSETS = 48
SPRINGS_DEG = (22.5, 112.5, 202.5, 292.5)
UMBILICALS_DEG = (58.0, 148.0)


def launch_adaptor_ring_parts() -> tuple[Part, ...]:
    """Return the ring proper, the bolts and gussets on it, and the fittings round it."""
    return (
        Part("launch_adaptor_ring", _ring(), "anodised_aluminium", smooth=True),
        Part("launch_adaptor_ring", _gussets(), "anodised_aluminium"),
        Part("launch_adaptor_ring", _bolts(), "bare_aluminium"),
        Part("separation_springs", _springs(), "bare_aluminium"),
        Part("umbilical_connectors", _umbilicals(), "black_paint"),
    )


def _ring() -> trimesh.Trimesh:
    """Turn the section: foot, wall, and flange with the clamp band's 15 degree chamfer below."""
    foot = FACE_Z_M + FOOT_M
    inner, outer = WALL_RADIUS_M - WALL_M, WALL_RADIUS_M
    flange_inner = RADIUS_M - FLANGE_WIDTH_M
    chamfer = LIP_M + (RADIUS_M - outer) * np.tan(np.deg2rad(15.0)) + 0.004
    return lathe(
        [
            (FOOT_INNER_M, FACE_Z_M),
            (FOOT_OUTER_M, FACE_Z_M),
            (FOOT_OUTER_M, foot),
            (outer, foot),
            (outer, -chamfer),
            (RADIUS_M, -LIP_M),
            (RADIUS_M, -0.0015),
            (RADIUS_M - 0.0015, 0.0),
            (flange_inner, 0.0),
            (flange_inner, -0.009),
            (inner, -0.018),
            (inner, foot),
            (FOOT_INNER_M, foot),
            (FOOT_INNER_M, FACE_Z_M),
        ],
        SEGMENTS,
    )


def _gussets() -> trimesh.Trimesh:
    """Return triangular webs between wall and foot, outside it."""
    foot = FACE_Z_M + FOOT_M
    reach, rise = FOOT_OUTER_M - WALL_RADIUS_M - 0.006, 0.085
    web = prism([(0.0, 0.0), (reach, 0.0), (reach, 0.01), (0.0, rise)], -0.002, 0.002)
    upright = RigidTransform(
        np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
        np.array([WALL_RADIUS_M, 0.0, foot]),
    )
    return _around(placed(web, upright), np.arange(GUSSETS) * 360.0 / GUSSETS)


def _bolts() -> trimesh.Trimesh:
    """Return the hexagonal heads on the foot, outside and inside the wall, with their washers."""
    foot = FACE_Z_M + FOOT_M
    bolt = joined(
        [
            prism(hexagon(0.013), foot + 0.0015, foot + 0.009),
            cylinder(0.0095, foot, foot + 0.0015, 8),
        ]
    )
    angles = (np.arange(BOLTS) + 0.5) * 360.0 / BOLTS
    outside = _around(shifted(bolt, (0.848, 0.0, 0.0)), angles)
    inside = _around(shifted(bolt, (0.790, 0.0, 0.0)), angles[::2])
    return joined([outside, inside])


def _springs() -> trimesh.Trimesh:
    """Return the separation springs' pads: brackets inside the wall, with a dished seat each."""
    bracket = joined(
        [
            box((0.055, 0.07, 0.012), (0.776, 0.0, -0.026)),
            box((0.012, 0.07, 0.09), (0.797, 0.0, -0.075)),
            shifted(cylinder(0.022, -0.020, -0.008, 20), (0.772, 0.0, 0.0)),
            shifted(cylinder(0.016, -0.130, -0.032, 16), (0.772, 0.0, 0.0)),
        ]
    )
    return _around(bracket, np.asarray(SPRINGS_DEG))


def _umbilicals() -> trimesh.Trimesh:
    """Return the two umbilical connectors on brackets outside the wall, level below the flange."""
    bracket = joined(
        [
            box((0.07, 0.12, 0.006), (0.877, 0.0, -0.040)),
            box((0.006, 0.12, 0.10), (0.909, 0.0, -0.093)),
            shifted(cylinder(0.025, -0.037, -0.014, 20), (0.877, -0.03, 0.0)),
            shifted(cylinder(0.025, -0.037, -0.014, 20), (0.877, 0.03, 0.0)),
        ]
    )
    return _around(bracket, np.asarray(UMBILICALS_DEG))


def _around(mesh: trimesh.Trimesh, angles_deg: np.ndarray) -> trimesh.Trimesh:
    """Copy a mesh round the z axis."""
    copies = []
    for angle in np.deg2rad(angles_deg):
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        copies.append(placed(mesh, RigidTransform(turn, np.zeros(3))))
    return joined(copies)
