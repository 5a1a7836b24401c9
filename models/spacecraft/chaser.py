"""The chaser: a body 1.2 m wide behind its own camera, so that it casts a shadow.

Frame: the camera's. The lens is the origin, axes are OpenCV's (x right, y down, z along the
boresight); the body fills z < 0 and its front face lies just behind the lens and the lamps.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import trimesh

from models.pose import RigidTransform
from models.spacecraft.mli_blanket import Blanket
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.solids import (
    bar,
    box,
    cylinder,
    joined,
    lathe,
    placed,
    shifted,
    standing,
    tiles,
)
from models.spacecraft.thruster import nozzle

WIDTH_M = 1.2  # x and y
LENGTH_M = 1.5
FRONT_Z_M = -0.005
BLANKET_PROUD_M = 0.022
CENTRE_OF_MASS_M = (0.0, 0.0, -1.5)  # Opromolla et al. 2022, section 4.1
WING_M = (1.0, 0.9)  # along x and along z
WING_GAP_M = 0.35
STOWED_ARM = "chaser_grapple_base"
CAMERA_RADIUS_M = 0.065
LENS_RADIUS_M = 0.016


@lru_cache(maxsize=1)
def chaser() -> Spacecraft:
    """Build the chaser; built once, the same triangles every time."""
    wings = [_wing(sign) for sign in (-1.0, 1.0)]
    return Spacecraft(
        name="chaser",
        parts=(
            Part("chaser_body", _body(), "bare_aluminium"),
            Part("chaser_blanket", _blankets(), "mli_gold"),
            Part("chaser_camera", _camera(), "black_paint", smooth=True),
            Part("chaser_camera", _lens(), "corner_cube_face", smooth=True),
            Part(STOWED_ARM, _grapple_base(), "anodised_aluminium"),
            Part("chaser_thrusters", _thrusters(), "titanium_nozzle", smooth=True),
            Part("chaser_wings", joined(w[0] for w in wings), "solar_substrate"),
            Part("chaser_wings", joined(w[1] for w in wings), "solar_cell"),
        ),
        markers=None,
        centre_of_mass=np.array(CENTRE_OF_MASS_M),
    )


def _front_panel_z() -> float:
    return FRONT_Z_M - BLANKET_PROUD_M - 0.001


def _body() -> trimesh.Trimesh:
    front, back = _front_panel_z() - 0.001, FRONT_Z_M - LENGTH_M
    inner = WIDTH_M - 2.0 * BLANKET_PROUD_M
    return box((inner, inner, front - back), (0.0, 0.0, 0.5 * (front + back)))


def _blankets() -> trimesh.Trimesh:
    """Return the foil of the front, round the camera, and of the four sides."""
    half, length = 0.5 * WIDTH_M - BLANKET_PROUD_M, LENGTH_M - BLANKET_PROUD_M
    front = Blanket((-half, -half), (half, half), 0.05, 7, hole=(0.0, 0.0, CAMERA_RADIUS_M + 0.01))
    side = Blanket((-half, -0.5 * length), (half, 0.5 * length), 0.07, 8)
    middle = _front_panel_z() - 0.5 * length
    pieces = [shifted(front.foil(), (0.0, 0.0, _front_panel_z()))]
    for axis in np.array([[1.0, 0, 0], [-1.0, 0, 0], [0, 1.0, 0], [0, -1.0, 0]]):
        across = np.cross(axis, [0.0, 0.0, -1.0])
        pieces.append(placed(side.foil(), standing(half * axis + [0, 0, middle], axis, across)))
    return joined(pieces)


def _camera() -> trimesh.Trimesh:
    """Return the camera's and the lamps' housing: its front lies behind both."""
    recess, back = FRONT_Z_M - 0.004, FRONT_Z_M - 0.12
    return lathe(
        [
            (0.0, back),
            (CAMERA_RADIUS_M, back),
            (CAMERA_RADIUS_M, FRONT_Z_M),
            (LENS_RADIUS_M, FRONT_Z_M),
            (LENS_RADIUS_M, recess),
            (0.0, recess),
        ],
        48,
    )


def _lens() -> trimesh.Trimesh:
    """Return the front glass, recessed in the housing."""
    return cylinder(LENS_RADIUS_M - 0.001, FRONT_Z_M - 0.0039, FRONT_Z_M - 0.002, 32)


def _grapple_base() -> trimesh.Trimesh:
    """Return the arm's base and two stowed links, folded back along the body's +y side."""
    y = 0.5 * WIDTH_M + 0.05
    return joined(
        [
            box((0.22, 0.10, 0.22), (0.0, y, -0.30)),
            bar((0.0, y + 0.10, -0.30), (0.0, y + 0.10, -1.25), 0.10, 0.10),
            bar((0.12, y + 0.10, -1.25), (0.12, y + 0.10, -0.45), 0.08, 0.08),
        ]
    )


def _thrusters() -> trimesh.Trimesh:
    """Return eight nozzles at the corners of front and back, exhausting sideways."""
    half = 0.5 * WIDTH_M
    nozzles = []
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            for z in (-0.15, FRONT_Z_M - LENGTH_M + 0.12):
                at = standing((sx * half, sy * (half - 0.1), z), (sx, 0.0, 0.0))
                nozzles.append(placed(nozzle(), at))
    return joined(nozzles)


def _wing(sign: float) -> tuple[trimesh.Trimesh, trimesh.Trimesh]:
    """Return a wing's panel with its boom, and its cells, which face -y (up in the image)."""
    centre = np.array([sign * (0.5 * WIDTH_M + WING_GAP_M + 0.5 * WING_M[0]), 0.0, -0.85])
    facing = RigidTransform(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]), centre)
    pitch = np.array([0.0825, 0.0625])
    counts = np.floor((np.array(WING_M) - 0.05) / pitch).astype(int)
    axes = [(np.arange(n) - 0.5 * (n - 1)) * step for n, step in zip(counts, pitch, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    cells = tiles(np.column_stack([grid, np.full(len(grid), 0.0112)]), (0.080, 0.060))
    boom = bar(
        (sign * (0.5 * WIDTH_M - 0.03), 0.0, -0.85),
        (sign * (0.5 * WIDTH_M + WING_GAP_M + 0.02), 0.0, -0.85),
        0.05,
        0.05,
    )
    panel = placed(box((*WING_M, 0.02)), facing)
    return joined([panel, boom]), placed(cells, facing)
