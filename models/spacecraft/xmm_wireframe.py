"""XMM-Newton's wireframe: 30 corners that an image shows, and a hull that hides them.

Wing corners and the sunshield's lie in the middle of their sheets' thickness. The craft mirrors
itself in y = 0 and in nothing else: no turn carries it onto itself. Half a turn about x comes
nearest: it carries the service module's box onto itself, the focal plane assembly's to 0.35 m from
itself and the wings to 0.88 m; only the sunshield's corners lie 1 to 1.4 m from any other.
"""

from __future__ import annotations

import numpy as np
import trimesh

from models.arrays import Floats
from models.spacecraft import xmm_layout as at
from models.spacecraft.hull import Outline, box_outline, hiding, sheet_outline, wireframe
from models.spacecraft.solids import box, lathe, placed, standing
from models.wireframe.wireframe import Wireframe

SIDES = {"plus_y": 1.0, "minus_y": -1.0}
TUBE_SIDES, HORN_SIDES, BAFFLE_SIDES = 16, 8, 8  # of the polygons that stand for circles


def xmm_wireframe() -> Wireframe:
    """Build the wireframe from the dimensions of the mesh."""
    return wireframe("xmm", [*_wings(), *_shield(), _service_module(), _focal_plane(), *_hidden()])


def wing_corners(sign: float) -> Floats:
    """Return inner sky, tip sky, tip tube and inner tube corner of a wing, (4, 3) m."""
    x = at.WING_X + 0.5 * at.WING.panel_m[0] * np.array([1.0, 1.0, -1.0, -1.0])
    y = sign * np.array([at.WING.inner_m, at.WING.tip_m, at.WING.tip_m, at.WING.inner_m])
    return np.column_stack([x, y, np.full(4, at.WING_Z - 0.5 * at.WING.thickness_m)])


def _wings() -> list[Outline]:
    ends = ("inner_sky", "tip_sky", "tip_tube", "inner_tube")
    return [
        sheet_outline(
            f"wing_{side}", tuple(f"wing_{side}_{end}" for end in ends), wing_corners(sign)
        )
        for side, sign in SIDES.items()
    ]


def shield_corners(sign: float) -> Floats:
    """Return one slanted panel: fold top, edge top, edge foot and fold foot, (4, 3) m."""
    foot = at.SERVICE_X[1]
    (fold_y, fold_z), (edge_y, edge_z) = at.SHIELD_FOLD, at.SHIELD_EDGE
    return np.array(
        [
            [at.SUNSHIELD_TOP_X, sign * fold_y, fold_z],
            [at.SHIELD_EDGE_TOP_X, sign * edge_y, edge_z],
            [foot, sign * edge_y, edge_z],
            [foot, sign * fold_y, fold_z],
        ]
    )


def _shield() -> list[Outline]:
    """Return the three panels; the fold's feet meet the service module and are no landmarks."""
    outlines = []
    for side, sign in SIDES.items():
        corners = shield_corners(sign)
        names = tuple(f"sunshield_{end}_{side}" for end in ("fold_top", "edge_top", "edge_foot"))
        whole = sheet_outline("sunshield", (*names, "foot"), corners)
        edges = ((0, 1), (1, 2))
        outlines.append(Outline("sunshield", names, corners[:3], edges, whole.triangles))
    left, right = shield_corners(-1.0), shield_corners(1.0)
    middle = sheet_outline("sunshield", ("", "", "", ""), [left[0], right[0], right[3], left[3]])
    tops = ("sunshield_fold_top_minus_y", "sunshield_fold_top_plus_y")
    return [*outlines, Outline("sunshield", tops, middle.points[:2], ((0, 1),), middle.triangles)]


def _service_module() -> Outline:
    y, z = at.SERVICE_HALF_Y, at.SERVICE_HALF_Z
    return box_outline("service_module", (at.SERVICE_X[0], -y, -z), (at.SERVICE_X[1], y, z))


def _focal_plane() -> Outline:
    y = at.FOCAL_HALF_Y
    low, high = (at.FOCAL_X[0], -y, at.FOCAL_Z[0]), (at.FOCAL_X[1], y, at.FOCAL_Z[1])
    return box_outline("focal_plane", low, high)


def _hidden() -> list[Outline]:
    """Return what only hides: tube, horns, baffles, outgassing baffle and thruster pods."""
    solids = [
        _round(0.0, 0.0, at.LOWER_TUBE_M, at.LOWER_TUBE_M, at.JOINT_X, at.SERVICE_X[0], TUBE_SIDES),
        _round(0.0, 0.0, at.UPPER_TUBE_M, at.UPPER_TUBE_M, at.FOCAL_X[1], at.JOINT_X, TUBE_SIDES),
    ]
    foot, mouth = at.HORN_M
    solids += [
        _round(y, z, mouth, foot, at.HORN_X, at.FOCAL_X[0], HORN_SIDES) for y, z in at.HORNS_YZ
    ]
    solids += [
        _round(y, z, at.BAFFLE_M, at.BAFFLE_M, at.SERVICE_X[1], at.BAFFLE_X, BAFFLE_SIDES)
        for y, z in baffle_centres()
    ]
    low, high = np.array(at.OUTGASSING_LOW), np.array(at.OUTGASSING_HIGH)
    solids.append(box(high - low, 0.5 * (low + high)))
    for y, z in at.PODS_YZ:
        solids.append(box(at.POD_M, (at.SERVICE_X[0] - 0.5 * at.POD_M[0], y, z)))
    return [hiding(solid) for solid in solids]


def _round(
    y: float, z: float, low_m: float, high_m: float, low_x: float, high_x: float, sides: int
) -> trimesh.Trimesh:
    """Return an open cone or cylinder along x through (y, z), of the circle's width on average."""
    swell = 1.0 / np.sinc(1.0 / sides)
    wall = lathe([(swell * low_m, low_x), (swell * high_m, high_x)], sides)
    return placed(wall, standing((0.0, y, z), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))


def baffle_centres() -> Floats:
    """Return (y, z) of the three telescopes, (3, 2) m."""
    angles = np.deg2rad(at.MIRRORS_DEG)
    return at.BAFFLE_FROM_AXIS_M * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
