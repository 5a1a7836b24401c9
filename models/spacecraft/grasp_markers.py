"""The three white dots by the grasping point, and the black board that carries them.

Opromolla et al. 2022, section 3.2, in the frame of the grasping point (TAPF: on the adaptor ring,
axes as the target's). Its Figure 9 alone gives the dots' places; these are ours, chosen to satisfy
all that its text says: radius 1 cm, on a black support of 30 by 10 cm, 0.2 m above the grasping
point, not collinear, at least 0.1 m apart, spread mostly along x, one of them out of the plane of
the face: it stands on a black boss, 45 mm high.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import trimesh

from models.arrays import Floats
from models.markers import MarkerPattern
from models.spacecraft.bus import FACE_Z_M
from models.spacecraft.launch_adaptor_ring import RADIUS_M
from models.spacecraft.maxar1300 import maxar1300
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.solids import box, cylinder, joined, shifted, tube
from models.wireframe.wireframe import Wireframe

BOARD = "grasp_board"
BOARD_M = (0.30, 0.10, 0.006)  # section 3.2
CENTRE_M = (0.0, 0.20)  # above the grasping point
PROUD_M = 1e-4  # of a dot before the black: two coats of paint
BOSS_RADIUS_M = 0.017
ANTENNA, ANTENNA_ASIDE_M = "telemetry_antenna", (-0.28, 0.0, 0.0)  # from the middle of the board
GRASPING_POINT_M = (0.0, RADIUS_M, 0.0)  # in the target's own frame

POINTS_IN_TARGET: dict[str, tuple[float, float, float]] = {
    "A": (-0.11, 0.175, 0.0),
    "B": (0.11, 0.175, 0.0),
    "C": (-0.015, 0.230, 0.045),
}

GRASP_MARKERS = MarkerPattern(
    names=tuple(POINTS_IN_TARGET),
    points_in_target=np.array(list(POINTS_IN_TARGET.values())),
    normals_in_target=np.tile([0.0, 0.0, 1.0], (len(POINTS_IN_TARGET), 1)),
    radius_m=0.01,
    paint="white_paint",
)


def maxar1300_grasp() -> Spacecraft:
    """Return the Maxar-1300 in the frame of its grasping point, with the board and its dots.

    Its retroreflectors, 1.1 m and more away, have their supports but no faces; its telemetry
    antenna makes room for the board.
    """
    whole = maxar1300()
    offset = -np.array(GRASPING_POINT_M)
    moved = tuple(
        replace(part, mesh=shifted(part.mesh, offset + _aside(part))) for part in whole.parts
    )
    return replace(
        whole,
        name="maxar1300_grasp",
        parts=(*moved, Part(BOARD, _board(), "marker_black")),
        markers=GRASP_MARKERS,
        centre_of_mass=whole.centre_of_mass + offset,
    )


def _aside(part: Part) -> Floats:
    return np.array(ANTENNA_ASIDE_M if part.name == ANTENNA else (0.0, 0.0, 0.0))


def _board() -> trimesh.Trimesh:
    """Return the board, the boss of the dot that stands out, and four posts down to the face."""
    x, y = CENTRE_M
    thickness = BOARD_M[2]
    pieces = [box(BOARD_M, (x, y, -PROUD_M - 0.5 * thickness))]
    for px, py, pz in POINTS_IN_TARGET.values():
        if pz > PROUD_M:
            boss = cylinder(BOSS_RADIUS_M, -PROUD_M, pz - PROUD_M, 64)
            pieces.append(shifted(boss, (px, py, 0.0)))
    for side in (-1.0, 1.0):
        for end in (-1.0, 1.0):
            px, py = x + side * 0.42 * BOARD_M[0], y + end * 0.35 * BOARD_M[1]
            foot, head = [px, py, FACE_Z_M], [px, py, -PROUD_M - thickness]
            pieces.append(tube([foot, head], 0.006, 12))
    return joined(pieces)


def grasp_board_outline() -> Wireframe:
    """Return the board's face, four corners and four edges, in the grasping point's frame."""
    x, y = CENTRE_M
    half_x, half_y = 0.5 * BOARD_M[0], 0.5 * BOARD_M[1]
    signs = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    corners = np.column_stack(
        [x + half_x * signs[:, 0], y + half_y * signs[:, 1], np.full(4, -PROUD_M)]
    )
    return Wireframe(
        name="maxar1300_grasp",
        landmark_names=("low_left", "low_right", "high_right", "high_left"),
        points_in_target=corners,
        appendage=np.zeros(4, dtype=bool),
        edges=np.array([[0, 1], [1, 2], [2, 3], [3, 0]]),
        triangles_in_target=corners[[[0, 1, 2], [0, 2, 3]]],
    )
