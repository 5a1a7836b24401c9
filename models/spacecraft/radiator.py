"""The radiators on +-y: panels tiled with optical solar reflectors (second-surface mirrors)."""

from __future__ import annotations

import numpy as np

from models.spacecraft.bus import HALF_M, RADIATOR_CENTRE_Z_M, RADIATOR_SIZE_M
from models.spacecraft.part import Part
from models.spacecraft.solar_wing import WING_Z_M
from models.spacecraft.solids import box, placed, standing, tiles, tilted

TILE_M = (0.039, 0.039)  # mirrors of 40 mm and less are what is made
TILE_GAP_M = 0.001
TILE_TILT_DEG = 0.15  # one standard deviation, from uneven adhesive
PANEL_PROUD_M = 0.025
DRIVE_CLEAR_M = 0.20  # no tiles round the solar array drive


def radiator_parts(sign: float) -> tuple[Part, ...]:
    """Return the radiator of the +y (``sign`` 1) or -y (-1) face."""
    name = "radiator_plus_y" if sign > 0.0 else "radiator_minus_y"
    at = standing((0.0, sign * HALF_M, RADIATOR_CENTRE_Z_M), (0.0, sign, 0.0), (-sign, 0.0, 0.0))
    size = np.array(RADIATOR_SIZE_M)
    panel = box((*size, PANEL_PROUD_M + 0.02), (0.0, 0.0, 0.5 * PANEL_PROUD_M - 0.01))
    pitch = np.array(TILE_M) + TILE_GAP_M
    counts = np.floor((size - 0.03) / pitch).astype(int)
    axes = [(np.arange(n) - 0.5 * (n - 1)) * step for n, step in zip(counts, pitch, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    drive = np.array([0.0, WING_Z_M - RADIATOR_CENTRE_Z_M])
    grid = grid[np.linalg.norm(grid - drive, axis=1) > DRIVE_CLEAR_M]
    mirrors = tiles(np.column_stack([grid, np.full(len(grid), PANEL_PROUD_M + 0.001)]), TILE_M)
    mirrors = tilted(mirrors, 4, TILE_TILT_DEG, 1301)
    return (
        Part(name, placed(panel, at), "white_paint"),
        Part(name, placed(mirrors, at), "optical_solar_reflector"),
    )
