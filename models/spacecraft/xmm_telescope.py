"""XMM-Newton's telescope tube and, at its far end, the focal plane assembly with its radiators.

Everything is wrapped in black foil against stray light and uneven heating. Two horns on the end
radiate the heat of the MOS cameras, flat panels that of the pn camera and of the gratings' cameras
("The XMM payload", XMM-Newton pages of ESA); a box on the shadow side is the outgassing baffle.
"""

from __future__ import annotations

import numpy as np
import trimesh

from models.pose import RigidTransform
from models.spacecraft import xmm_layout as at
from models.spacecraft.foil import box_foil, tube_foil
from models.spacecraft.part import Part
from models.spacecraft.solids import box, cup, cylinder, joined, lathe, placed, standing

FOIL = "mli_black"
BLANKET_M = 0.012  # the structure lies this far inside the held-down foil
SEGMENTS = 96
RELIEF_M, FACET_M = 0.010, 0.055  # on boxes, whose edges are seen against the sky
TUBE_RELIEF_M = 0.024
SEAM_PITCH_M = 0.84  # between the rings that hold the tube's blankets
RADIATOR_M = 0.035  # by which the flat radiators stand proud


def along_x(y: float = 0.0, z: float = 0.0) -> RigidTransform:
    """Return the pose of a lathed part whose axis runs along x through (y, z); its x is y."""
    return standing((0.0, y, z), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


def telescope_parts() -> tuple[Part, ...]:
    """Return tube, focal plane assembly, radiators and outgassing baffle."""
    return (
        Part("telescope_tube", _tube(), "carbon_fibre", smooth=True),
        Part("telescope_tube", _tube_foil(), FOIL, smooth=True),
        Part("telescope_tube", _joint(), FOIL, smooth=True),
        Part("outgassing_baffle", _outgassing_baffle(), FOIL),
        Part("focal_plane_assembly", _focal_plane(), "carbon_fibre"),
        Part("focal_plane_assembly", _focal_foil(), FOIL, smooth=True),
        Part("mos_radiators", _horns(), "black_paint", smooth=True),
        Part("mos_radiators", _horn_rims(), "bare_aluminium", smooth=True),
        Part("camera_radiators", _radiators(), "white_paint"),
    )


def _tube() -> trimesh.Trimesh:
    lower, upper = at.LOWER_TUBE_M - BLANKET_M, at.UPPER_TUBE_M - BLANKET_M
    return joined(
        [
            placed(cylinder(lower, at.JOINT_X, at.SERVICE_X[0] + 0.1, SEGMENTS), along_x()),
            placed(cylinder(upper, at.FOCAL_X[1] - 0.1, at.JOINT_X, SEGMENTS), along_x()),
        ]
    )


def _tube_foil() -> trimesh.Trimesh:
    halves = (
        (at.LOWER_TUBE_M, at.JOINT_X, at.SERVICE_X[0], 1910),
        (at.UPPER_TUBE_M, at.FOCAL_X[1], at.JOINT_X, 1920),
    )
    pieces = []
    for radius, bottom, top, seed in halves:
        seams = tuple(np.arange(SEAM_PITCH_M, top - bottom - 0.2, SEAM_PITCH_M).tolist())
        foil = tube_foil(radius, bottom, top, FACET_M, seed, TUBE_RELIEF_M, seams)
        pieces.append(placed(foil, along_x()))
    return joined(pieces)


def _joint() -> trimesh.Trimesh:
    """Return the flange where the halves are bolted together."""
    x, inner, half = at.JOINT_X, at.UPPER_TUBE_M - 0.02, 0.03
    ring = [
        (inner, x - half),
        (at.JOINT_M, x - half),
        (at.JOINT_M, x + half),
        (inner, x + half),
        (inner, x - half),
    ]
    return placed(lathe(ring, SEGMENTS), along_x())


def _outgassing_baffle() -> trimesh.Trimesh:
    low, high = np.array(at.OUTGASSING_LOW), np.array(at.OUTGASSING_HIGH)
    return box(high - low, 0.5 * (low + high))


def focal_bounds() -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Return the lowest and the highest corner of the focal plane assembly's box, m."""
    y = at.FOCAL_HALF_Y
    return (at.FOCAL_X[0], -y, at.FOCAL_Z[0]), (at.FOCAL_X[1], y, at.FOCAL_Z[1])


def _focal_plane() -> trimesh.Trimesh:
    low, high = (np.array(end) for end in focal_bounds())
    return box(high - low - 2.0 * BLANKET_M, 0.5 * (low + high))


def _focal_foil() -> trimesh.Trimesh:
    low, high = focal_bounds()
    return box_foil(low, high, FACET_M, 1930, RELIEF_M)


def _horns() -> trimesh.Trimesh:
    """Return the two cones, mouths away from the mirrors."""
    foot, mouth = at.HORN_M
    length = at.FOCAL_X[0] - at.HORN_X
    horn = cup(foot, mouth, -0.01, length, 0.006, 48)
    return joined(
        placed(horn, standing((at.FOCAL_X[0], y, z), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
        for y, z in at.HORNS_YZ
    )


def _horn_rims() -> trimesh.Trimesh:
    mouth, length = at.HORN_M[1], at.FOCAL_X[0] - at.HORN_X
    inner, outer = mouth - 0.004, mouth + 0.012
    ring = [
        (inner, length - 0.02),
        (outer, length - 0.02),
        (outer, length),
        (inner, length),
        (inner, length - 0.02),
    ]
    return joined(
        placed(lathe(ring, 48), standing((at.FOCAL_X[0], y, z), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
        for y, z in at.HORNS_YZ
    )


def _radiators() -> trimesh.Trimesh:
    """Return the pn camera's panel on the end and the gratings' cameras' on the shadow side."""
    x0, x1 = at.FOCAL_X
    z = at.FOCAL_Z[0] - 0.5 * RADIATOR_M
    middle = 0.5 * (x0 + x1)
    return joined(
        [
            box((RADIATOR_M, 0.86, 0.55), (x0 - 0.5 * RADIATOR_M, 0.0, 0.45)),
            *(box((0.70, 0.72, RADIATOR_M), (middle, y, z)) for y in (-0.52, 0.52)),
        ]
    )
