"""A deployed communication reflector on +-x: an offset paraboloid, its arm, and its feed.

Both beams point at Earth, along -z. The parent paraboloid's axis runs beside the bus; the feed
horn at its focus, over the Earth deck's edge, looks back at the dish.
"""

from __future__ import annotations

import numpy as np
import trimesh

from models.arrays import Floats
from models.pose import RigidTransform
from models.spacecraft.bus import EARTH_FACE_Z_M, HALF_M
from models.spacecraft.part import Part
from models.spacecraft.solids import (
    bar,
    box,
    cup,
    cylinder,
    joined,
    lathe,
    mesh_of,
    placed,
    standing,
    tube,
)

DIAMETER_M = 2.2
FOCAL_LENGTH_M = 1.9
AXIS_X_M = 1.32  # of the parent paraboloid
CLEARANCE_M = 0.35  # from the axis to the dish's inner edge
VERTEX_Z_M = -2.0
SHELL_M = 0.022
FOCUS = np.array([AXIS_X_M, 0.0, VERTEX_Z_M - FOCAL_LENGTH_M])
CENTRE_X_M = AXIS_X_M + CLEARANCE_M + 0.5 * DIAMETER_M
RINGS, SPOKES = 14, 72


def offset_reflector_parts(sign: float) -> tuple[Part, ...]:
    """Return dish, arm and feed on the +x (``sign`` 1) or -x (-1) side."""
    side = "plus_x" if sign > 0.0 else "minus_x"
    turn = RigidTransform(np.diag([sign, sign, 1.0]), np.zeros(3))  # half a turn about z, or none
    pieces = (
        ("reflector", _face(), "white_paint", True),
        ("reflector", _back(), "carbon_fibre", True),
        ("reflector", _ribs(), "carbon_fibre", False),
        ("reflector_arm", _arm(), "carbon_fibre", False),
        ("reflector_arm", _hinge(), "anodised_aluminium", False),
        ("feed", _horn(), "bare_aluminium", True),
        ("feed", _feed_bracket(), "white_paint", False),
    )
    return tuple(
        Part(f"{name}_{side}", placed(mesh, turn), material, smooth)
        for name, mesh, material, smooth in pieces
    )


def surface_height(x: Floats, y: Floats) -> Floats:
    """Return z of the reflecting face, m: ``z = z_vertex - rho^2 / 4 f``."""
    return np.asarray(VERTEX_Z_M - ((x - AXIS_X_M) ** 2 + y**2) / (4.0 * FOCAL_LENGTH_M))


def _disc_grid() -> tuple[Floats, Floats]:
    """Return (rings, spokes) x and y of the dish; ring 0 is its centre."""
    radius = 0.5 * DIAMETER_M * np.linspace(0.0, 1.0, RINGS)[:, None]
    angle = 2.0 * np.pi * np.arange(SPOKES) / SPOKES
    return CENTRE_X_M + radius * np.cos(angle), radius * np.sin(angle)


def _sheet(rows: Floats, upward: bool) -> trimesh.Trimesh:
    """Join rings of points, the first of them a pole, into a surface."""
    i, j = np.meshgrid(np.arange(len(rows) - 1), np.arange(SPOKES), indexing="ij")
    a, b = i * SPOKES + j, i * SPOKES + (j + 1) % SPOKES
    d, c = a + SPOKES, b + SPOKES
    faces = np.concatenate(
        [
            np.stack([a, d, c], axis=-1).reshape(-1, 3),
            np.stack([a, c, b], axis=-1)[1:].reshape(-1, 3),
        ]
    )
    return mesh_of(rows.reshape(-1, 3), faces if upward else faces[:, ::-1])


def _face() -> trimesh.Trimesh:
    """Return the reflecting side, concave towards Earth."""
    x, y = _disc_grid()
    return _sheet(np.stack([x, y, surface_height(x, y)], axis=-1), upward=False)


def _back() -> trimesh.Trimesh:
    """Return the back and the edge of the shell."""
    x, y = _disc_grid()
    z = surface_height(x, y)
    back = np.stack([x, y, z + SHELL_M], axis=-1)
    rim = np.stack([back[-1], np.stack([x[-1], y[-1], z[-1]], axis=-1)])
    j = np.arange(SPOKES)
    after = (j + 1) % SPOKES
    edge = np.concatenate(
        [
            np.stack([j, j + SPOKES, after + SPOKES], axis=-1),
            np.stack([j, after + SPOKES, after], axis=-1),
        ]
    )
    return joined([_sheet(back, upward=True), mesh_of(rim.reshape(-1, 3), edge)])


def _on_back(x: Floats, y: Floats) -> Floats:
    return np.stack([x, y, surface_height(x, y) + SHELL_M + 0.02], axis=-1)


def _ribs() -> trimesh.Trimesh:
    """Return the stiffening ring and six radial ribs on the back, and the hub of the arm."""
    angle = 2.0 * np.pi * np.arange(49) / 48
    reach = 0.29 * DIAMETER_M
    ring = tube(_on_back(CENTRE_X_M + reach * np.cos(angle), reach * np.sin(angle)), 0.022, 6)
    ribs = []
    for turn in np.deg2rad(np.arange(0.0, 360.0, 60.0)):
        radius = np.linspace(0.06, 0.46, 9) * DIAMETER_M
        ribs.append(
            tube(_on_back(CENTRE_X_M + radius * np.cos(turn), radius * np.sin(turn)), 0.022, 6)
        )
    centre = _on_back(np.array(CENTRE_X_M), np.array(0.0))
    hub = placed(cylinder(0.15, -0.02, 0.05, 24), standing(centre, _normal_at_centre()))
    return joined([ring, *ribs, hub])


def _normal_at_centre() -> Floats:
    """Return the back's normal at the dish's centre."""
    slope = -(CENTRE_X_M - AXIS_X_M) / (2.0 * FOCAL_LENGTH_M)
    normal = np.array([-slope, 0.0, 1.0])
    return normal / np.linalg.norm(normal)


def _arm() -> trimesh.Trimesh:
    """Return the two struts from the bus's hinge to the hub on the dish's back."""
    hub = _on_back(np.array(CENTRE_X_M), np.array(0.0)) + 0.05 * _normal_at_centre()
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


def _towards_dish() -> Floats:
    middle = np.array([CENTRE_X_M, 0.0, float(surface_height(np.array(CENTRE_X_M), np.array(0.0)))])
    return middle - FOCUS


def _horn() -> trimesh.Trimesh:
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
    return placed(horn, standing(FOCUS, _towards_dish()))


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
    at = standing(FOCUS, _towards_dish())
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
