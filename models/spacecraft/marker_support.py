"""What carries the retroreflectors: a black plate under each, on a post that stands on the bus.

The paper mounts its markers on dedicated supports, off the blanket (Opromolla et al. 2022,
sections 2 and 3.1). A plate lies 1 mm behind its marker's face and is as wide as its neighbours'
lines of sight allow; a bezel, flush with the face so that it hides nothing of it, holds the cube.
"""

from __future__ import annotations

import numpy as np
import trimesh

from models.arrays import Floats
from models.markers import MarkerPattern
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
    standing,
    tube,
)

SUPPORTS = "marker_supports"
FACE_PROUD_M = 0.001
PLATE_M = 0.004
PLATE_RADIUS_M = 0.045
POST_RADIUS_M = 0.010
BASE_M = 0.09
BASE_LIFT_M = 0.003
BEZEL_GAP_M, BEZEL_M = 0.0003, 0.0025
SIGHT_MARGIN_M = 0.002


def marker_support_parts(markers: MarkerPattern) -> tuple[Part, ...]:
    """Return the supports of a pattern, all black, as ``marker_supports``."""
    widths = plate_radii(markers)
    supports = [
        _support(point, normal, float(width))
        for point, normal, width in zip(
            markers.points_in_target, markers.normals_in_target, widths, strict=True
        )
    ]
    bezels = [
        placed(lathe(_bezel(markers.radius_m), 48), standing(point, normal))
        for point, normal in zip(markers.points_in_target, markers.normals_in_target, strict=True)
    ]
    return (
        Part(SUPPORTS, joined(supports), "black_paint"),
        Part(SUPPORTS, joined(bezels), "anodised_aluminium"),
    )


def _bezel(radius_m: float) -> list[tuple[float, float]]:
    """Return the section, (radius, height) m, of the ring around a marker's face."""
    inner, outer = radius_m + BEZEL_GAP_M, radius_m + BEZEL_GAP_M + BEZEL_M
    bottom = -FACE_PROUD_M
    return [(inner, bottom), (outer, bottom), (outer, 0.0), (inner, 0.0), (inner, bottom)]


def plate_radii(markers: MarkerPattern) -> Floats:
    """Return the plates' radii, (n,) m: smaller where a taller plate would shade a neighbour.

    A plate that stands higher than a neighbour's face by h, at a distance d from it, must end
    d - h short of it to leave its lines of sight free up to 45 degrees.
    """
    points = markers.points_in_target
    distance = np.linalg.norm(points[:, None, :2] - points[None, :, :2], axis=-1)
    higher = points[:, None, 2] - points[None, :, 2]
    room = np.where(higher > 0.0, distance - higher - SIGHT_MARGIN_M, np.inf).min(axis=1)
    return np.clip(room, 1.5 * markers.radius_m, PLATE_RADIUS_M)


def _support(point: Floats, normal: Floats, plate_radius: float) -> trimesh.Trimesh:
    """Return one plate, its post and its bolted base, in the target frame."""
    angles = 2.0 * np.pi * (np.arange(16) + 0.5) / 16
    outline = plate_radius * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    plate = prism(outline, -FACE_PROUD_M - PLATE_M, -FACE_PROUD_M)
    boss = cylinder(0.017, -FACE_PROUD_M - PLATE_M - 0.012, -FACE_PROUD_M - PLATE_M, 16)
    neck = point - (FACE_PROUD_M + PLATE_M) * normal
    foot = np.array([point[0], point[1], FACE_Z_M + BASE_LIFT_M])
    return joined(
        [
            placed(joined([plate, boss]), standing(point, normal)),
            tube([foot, neck], POST_RADIUS_M, 12),
            shifted(_base(), foot),
        ]
    )


def _base() -> trimesh.Trimesh:
    """Return the base: a plate with a collar, four bolts and four webs to the post."""
    pieces = [
        box((BASE_M, BASE_M, 0.006), (0.0, 0.0, 0.003)),
        cylinder(0.018, 0.006, 0.03, 16),
    ]
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            corner = 0.4 * BASE_M * np.array([sx, sy, 0.0])
            pieces.append(shifted(prism(hexagon(0.010), 0.006, 0.012), corner))
            pieces.append(
                tube([[0.7 * corner[0], 0.7 * corner[1], 0.006], [0.0, 0.0, 0.05]], 0.003, 6)
            )
    return joined(pieces)
