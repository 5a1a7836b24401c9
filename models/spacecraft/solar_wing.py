"""A solar wing: drive, yoke and five panels of strings of cells, along +-y.

Triple-junction cells under coverglass, two corners of each cropped, in strings along the wing.
Three silver tabs lead from each cell under its neighbour in the string and show in the gap
between them; bus bars close the strings at both ends. Panels of a 1300 stow against the +-y faces,
so one is no larger than 2.4 by 3.6 m; five a side give a span of 29 m.
"""

from __future__ import annotations

import numpy as np
import trimesh

from models.arrays import Floats
from models.pose import RigidTransform
from models.spacecraft.bus import HALF_M
from models.spacecraft.part import Part
from models.spacecraft.solids import (
    bar,
    box,
    cropped_tiles,
    cylinder,
    joined,
    placed,
    shifted,
    tiles,
    tilted,
)

PANELS = 5
PANEL_M = (3.30, 2.25)  # across the wing and along it
PANEL_THICKNESS_M = 0.025
PANEL_GAP_M = 0.04
RIM_M = 0.018
CELL_M = (0.080, 0.060)  # across and along
CELL_GAP_M = 0.0025
EDGE_M = 0.045  # from the panel's edge to the first cell
CELL_RISE_M = 0.0022  # of the glass above the substrate
TAB_RISE_M, COVER_RISE_M = 0.0007, 0.0011
CELL_CROP_M = 0.009
CELL_TILT_DEG = 0.25  # one standard deviation, from uneven adhesive and a warped face sheet
TABS_M = (-0.027, 0.0, 0.027)  # where the interconnects of a string run, from its middle
TAB_M = 0.006
HOLD_DOWNS = ((-1.05, -0.62), (1.05, -0.62), (-1.05, 0.62), (1.05, 0.62), (0.0, 0.0))
HOLD_DOWN_CLEAR_M = 0.025  # from a hold-down to the nearest cell
YOKE_M = 1.70
DRIVE_M = 0.16
WING_Z_M = -1.95

# Tip of each wing, m along y from the target's origin.
TIP_M = HALF_M + DRIVE_M + YOKE_M + PANELS * PANEL_M[1] + (PANELS - 1) * PANEL_GAP_M


def solar_wing_parts(sign: float) -> tuple[Part, ...]:
    """Return the wing on the +y (``sign`` 1) or -y (-1) side; cells face +z, towards the chaser."""
    side = "plus_y" if sign > 0.0 else "minus_y"
    wing, yoke = f"solar_wing_{side}", f"yoke_{side}"
    pieces = {
        (wing, "solar_substrate"): _substrates(),
        (wing, "carbon_fibre"): _rims(),
        (wing, "solar_cell"): _cells(),
        (wing, "solar_interconnect"): _interconnects(),
        (yoke, "carbon_fibre"): _yoke(),
        (yoke, "anodised_aluminium"): _drive(),
    }
    turn = np.diag([sign, sign, 1.0])  # half a turn about z, or none
    at = RigidTransform(turn, np.array([0.0, 0.0, WING_Z_M]))
    return tuple(
        Part(name, placed(mesh, at), material) for (name, material), mesh in pieces.items()
    )


def _panel_centres() -> list[Floats]:
    first = HALF_M + DRIVE_M + YOKE_M + 0.5 * PANEL_M[1]
    step = PANEL_M[1] + PANEL_GAP_M
    return [np.array([0.0, first + k * step, 0.0]) for k in range(PANELS)]


def _on_every_panel(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    return joined(shifted(mesh, centre) for centre in _panel_centres())


def _substrates() -> trimesh.Trimesh:
    """Return the panels, top at z = 0, and covers over the wiring where cells are left out."""
    slab = box((*PANEL_M, PANEL_THICKNESS_M), (0.0, 0.0, -0.5 * PANEL_THICKNESS_M))
    size = 2.0 * (np.array(CELL_M) + HOLD_DOWN_CLEAR_M)
    covers = [box((*size, COVER_RISE_M), (x, y, 0.5 * COVER_RISE_M)) for x, y in HOLD_DOWNS]
    return _on_every_panel(joined([slab, *covers]))


def _rims() -> trimesh.Trimesh:
    """Return the edge members of the panels, the hinges between them, and the hold-downs."""
    x, y = 0.5 * PANEL_M[0], 0.5 * PANEL_M[1]
    depth = PANEL_THICKNESS_M + 0.006
    middle = -0.5 * PANEL_THICKNESS_M
    pieces = [
        box((RIM_M, PANEL_M[1], depth), (sx * (x - 0.5 * RIM_M), 0.0, middle)) for sx in (-1, 1)
    ]
    pieces += [
        box((PANEL_M[0] - 2 * RIM_M, RIM_M, depth), (0.0, sy * (y - 0.5 * RIM_M), middle))
        for sy in (-1, 1)
    ]
    pieces += [
        box((0.09, PANEL_GAP_M + 0.03, 0.045), (hx, -y - 0.5 * PANEL_GAP_M, -0.012))
        for hx in (-1.2, 1.2)
    ]
    pieces += [
        joined([shifted(cylinder(0.028, 0.0, 0.008, 16), (hx, hy, 0.0))]) for hx, hy in HOLD_DOWNS
    ]
    return _on_every_panel(joined(pieces))


def _cell_centres() -> Floats:
    """Return where the cells of one panel lie, (n, 3) m; none over a hold-down."""
    pitch = np.array(CELL_M) + CELL_GAP_M
    counts = np.floor((np.array(PANEL_M) - 2.0 * EDGE_M + CELL_GAP_M) / pitch).astype(int)
    axes = [(np.arange(n) - 0.5 * (n - 1)) * step for n, step in zip(counts, pitch, strict=True)]
    centres = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    away = np.abs(centres[:, None, :] - np.array(HOLD_DOWNS)) - 0.5 * np.array(CELL_M)
    free = (away.max(axis=2) > HOLD_DOWN_CLEAR_M).all(axis=1)
    return np.column_stack([centres[free], np.full(free.sum(), CELL_RISE_M)])


def _cells() -> trimesh.Trimesh:
    """Return the cells of all panels; each lies a little uneven, as bonded cells do."""
    panel = cropped_tiles(_cell_centres(), CELL_M, CELL_CROP_M)
    return joined(
        shifted(tilted(panel, 6, CELL_TILT_DEG, 1300 + number), centre)
        for number, centre in enumerate(_panel_centres())
    )


def _interconnects() -> trimesh.Trimesh:
    """Return the tabs, strips that the cells hide but for the gaps, and the bus bars.

    Seen from the front, a strip under a whole string is what its separate tabs are.
    """
    columns = np.unique(_cell_centres()[:, 0].round(6))
    tabs = (columns[:, None] + np.array(TABS_M)).ravel()
    length = PANEL_M[1] - 2.0 * EDGE_M
    height = TAB_RISE_M
    strips = tiles(
        np.column_stack([tabs, np.zeros_like(tabs), np.full_like(tabs, height)]), (TAB_M, length)
    )
    width = PANEL_M[0] - 2.0 * EDGE_M
    y = 0.5 * length + 0.009
    bars = tiles([[0.0, -y, height], [0.0, y, height]], (width, 0.008))
    return _on_every_panel(joined([strips, bars]))


def _yoke() -> trimesh.Trimesh:
    """Return the V of tubes from the drive to the first panel, with its cross bars."""
    root, end = HALF_M + DRIVE_M, HALF_M + DRIVE_M + YOKE_M
    z = -0.5 * PANEL_THICKNESS_M
    legs = [bar((sx * 0.06, root, z), (sx * 1.2, end, z), 0.06, 0.04) for sx in (-1.0, 1.0)]
    half = 0.06 + (1.2 - 0.06) * 0.55
    middle = root + 0.55 * YOKE_M
    return joined(
        [
            *legs,
            bar((-half, middle, z), (half, middle, z), 0.045, 0.035),
            bar((-1.22, end - 0.02, z), (1.22, end - 0.02, z), 0.05, 0.04),
        ]
    )


def _drive() -> trimesh.Trimesh:
    """Return the drive's housing on the bus and the root fitting of the yoke."""
    along_y = RigidTransform(
        np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]), np.zeros(3)
    )
    housing = joined(
        [
            cylinder(0.14, HALF_M - 0.02, HALF_M + 0.10, 32),
            cylinder(0.07, HALF_M + 0.10, HALF_M + DRIVE_M, 24),
        ]
    )
    root = box((0.24, 0.08, 0.07), (0.0, HALF_M + DRIVE_M, -0.5 * PANEL_THICKNESS_M))
    return joined([placed(housing, along_y), root])
