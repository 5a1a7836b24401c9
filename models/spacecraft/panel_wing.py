"""A solar wing of any size: drive, yoke and panels of strings of cells, along +y of its own frame.

Triple-junction cells under coverglass, two corners of each cropped, in strings along the wing.
Three silver tabs lead from each cell under its neighbour in the string and show in the gap
between them; bus bars close the strings at both ends. Cells face +z; z = 0 is the panels' front,
y = 0 lies wherever ``root_m`` is counted from.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh

from models.arrays import Floats
from models.pose import RigidTransform
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

CELL_M = (0.080, 0.060)  # across and along
CELL_GAP_M = 0.0025
EDGE_M = 0.045  # from the panel's edge to the first cell
CELL_RISE_M = 0.0022  # of the glass above the substrate
TAB_RISE_M, COVER_RISE_M = 0.0007, 0.0011
CELL_CROP_M = 0.009
CELL_TILT_DEG = 0.25  # one standard deviation, from uneven adhesive and a warped face sheet
TABS_M = (-0.027, 0.0, 0.027)  # where the interconnects of a string run, from its middle
TAB_M = 0.006
HOLD_DOWN_CLEAR_M = 0.025  # from a hold-down to the nearest cell


@dataclass(frozen=True)
class PanelWing:
    """The sizes of a wing.

    Attributes
    ----------
    panels : int
    panel_m : (float, float), m
        Across the wing, x, and along it, y.
    root_m : float, m
        y of the face that the drive stands on.
    drive_m, yoke_m : float, m
        Lengths of the drive's housing and of the yoke.
    yoke_half_m : float, m
        Half of the yoke's width at the first panel.
    gap_m, thickness_m, rim_m : float, m
        Between panels; of a panel; width of the edge members.
    rim_proud_m : float, m
        By how much the edge members stand out on both sides of a panel.
    hinges_m : tuple of float, m
        x of the hinges between panels.
    hold_downs_m : tuple of (float, float), m
        (x, y) on each panel, from its middle.
    seed : int
        Of the cells' tilts.
    """

    panels: int
    panel_m: tuple[float, float]
    root_m: float
    drive_m: float
    yoke_m: float
    yoke_half_m: float
    gap_m: float
    thickness_m: float
    rim_m: float
    rim_proud_m: float
    hinges_m: tuple[float, ...]
    hold_downs_m: tuple[tuple[float, float], ...]
    seed: int

    @property
    def tip_m(self) -> float:
        """Where the wing ends, y in m."""
        along = self.panels * self.panel_m[1] + (self.panels - 1) * self.gap_m
        return self.inner_m + along

    @property
    def inner_m(self) -> float:
        """Where the first panel begins, y in m."""
        return self.root_m + self.drive_m + self.yoke_m

    def parts(self, side: str, body_from_wing: RigidTransform) -> tuple[Part, ...]:
        """Return the parts ``solar_wing_{side}`` and ``yoke_{side}`` in the body frame."""
        wing, yoke = f"solar_wing_{side}", f"yoke_{side}"
        pieces = {
            (wing, "solar_substrate"): self._substrates(),
            (wing, "carbon_fibre"): self._rims(),
            (wing, "solar_cell"): self._cells(),
            (wing, "solar_interconnect"): self._interconnects(),
            (yoke, "carbon_fibre"): self._yoke(),
            (yoke, "anodised_aluminium"): self._drive(),
        }
        return tuple(
            Part(name, placed(mesh, body_from_wing), material)
            for (name, material), mesh in pieces.items()
        )

    def _panel_centres(self) -> list[Floats]:
        first = self.inner_m + 0.5 * self.panel_m[1]
        step = self.panel_m[1] + self.gap_m
        return [np.array([0.0, first + k * step, 0.0]) for k in range(self.panels)]

    def _on_every_panel(self, mesh: trimesh.Trimesh) -> trimesh.Trimesh:
        return joined(shifted(mesh, centre) for centre in self._panel_centres())

    def _substrates(self) -> trimesh.Trimesh:
        """Return the panels, top at z = 0, and covers over the wiring where cells are left out."""
        slab = box((*self.panel_m, self.thickness_m), (0.0, 0.0, -0.5 * self.thickness_m))
        size = 2.0 * (np.array(CELL_M) + HOLD_DOWN_CLEAR_M)
        covers = [
            box((*size, COVER_RISE_M), (x, y, 0.5 * COVER_RISE_M)) for x, y in self.hold_downs_m
        ]
        return self._on_every_panel(joined([slab, *covers]))

    def _rims(self) -> trimesh.Trimesh:
        """Return the edge members of the panels, the hinges between them, and the hold-downs."""
        x, y = 0.5 * self.panel_m[0], 0.5 * self.panel_m[1]
        depth = self.thickness_m + 2.0 * self.rim_proud_m
        middle = -0.5 * self.thickness_m
        rim = self.rim_m
        pieces = [
            box((rim, self.panel_m[1], depth), (sx * (x - 0.5 * rim), 0.0, middle))
            for sx in (-1, 1)
        ]
        pieces += [
            box((self.panel_m[0] - 2 * rim, rim, depth), (0.0, sy * (y - 0.5 * rim), middle))
            for sy in (-1, 1)
        ]
        pieces += [
            box((0.09, self.gap_m + 0.03, 0.045), (hx, -y - 0.5 * self.gap_m, -0.012))
            for hx in self.hinges_m
        ]
        pieces += [
            joined([shifted(cylinder(0.028, 0.0, 0.008, 16), (hx, hy, 0.0))])
            for hx, hy in self.hold_downs_m
        ]
        return self._on_every_panel(joined(pieces))

    def _cell_centres(self) -> Floats:
        """Return where the cells of one panel lie, (n, 3) m; none over a hold-down."""
        pitch = np.array(CELL_M) + CELL_GAP_M
        counts = np.floor((np.array(self.panel_m) - 2.0 * EDGE_M + CELL_GAP_M) / pitch).astype(int)
        axes = [
            (np.arange(n) - 0.5 * (n - 1)) * step for n, step in zip(counts, pitch, strict=True)
        ]
        centres = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
        away = np.abs(centres[:, None, :] - np.array(self.hold_downs_m)) - 0.5 * np.array(CELL_M)
        free = (away.max(axis=2) > HOLD_DOWN_CLEAR_M).all(axis=1)
        return np.column_stack([centres[free], np.full(free.sum(), CELL_RISE_M)])

    def _cells(self) -> trimesh.Trimesh:
        """Return the cells of all panels; each lies a little uneven, as bonded cells do."""
        panel = cropped_tiles(self._cell_centres(), CELL_M, CELL_CROP_M)
        return joined(
            shifted(tilted(panel, 6, CELL_TILT_DEG, self.seed + number), centre)
            for number, centre in enumerate(self._panel_centres())
        )

    def _interconnects(self) -> trimesh.Trimesh:
        """Return the tabs, strips that the cells hide but for the gaps, and the bus bars.

        Seen from the front, a strip under a whole string is what its separate tabs are.
        """
        columns = np.unique(self._cell_centres()[:, 0].round(6))
        tabs = (columns[:, None] + np.array(TABS_M)).ravel()
        length = self.panel_m[1] - 2.0 * EDGE_M
        height = TAB_RISE_M
        strips = tiles(
            np.column_stack([tabs, np.zeros_like(tabs), np.full_like(tabs, height)]),
            (TAB_M, length),
        )
        width = self.panel_m[0] - 2.0 * EDGE_M
        y = 0.5 * length + 0.009
        bars = tiles([[0.0, -y, height], [0.0, y, height]], (width, 0.008))
        return self._on_every_panel(joined([strips, bars]))

    def _yoke(self) -> trimesh.Trimesh:
        """Return the V of tubes from the drive to the first panel, with its cross bars."""
        root, end = self.root_m + self.drive_m, self.inner_m
        z = -0.5 * self.thickness_m
        wide = self.yoke_half_m
        legs = [bar((sx * 0.06, root, z), (sx * wide, end, z), 0.06, 0.04) for sx in (-1.0, 1.0)]
        half = 0.06 + (wide - 0.06) * 0.55
        middle = root + 0.55 * self.yoke_m
        return joined(
            [
                *legs,
                bar((-half, middle, z), (half, middle, z), 0.045, 0.035),
                bar((-wide - 0.02, end - 0.02, z), (wide + 0.02, end - 0.02, z), 0.05, 0.04),
            ]
        )

    def _drive(self) -> trimesh.Trimesh:
        """Return the drive's housing on the bus and the root fitting of the yoke."""
        along_y = RigidTransform(
            np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]), np.zeros(3)
        )
        neck = self.root_m + 0.625 * self.drive_m
        housing = joined(
            [
                cylinder(0.14, self.root_m - 0.02, neck, 32),
                cylinder(0.07, neck, self.root_m + self.drive_m, 24),
            ]
        )
        root = box((0.24, 0.08, 0.07), (0.0, self.root_m + self.drive_m, -0.5 * self.thickness_m))
        return joined([placed(housing, along_y), root])
