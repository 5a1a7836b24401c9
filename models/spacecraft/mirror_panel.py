"""A radiator: a panel tiled with optical solar reflectors, second-surface mirrors."""

from __future__ import annotations

import numpy as np
import trimesh

from models.spacecraft.solids import box, tiles, tilted

TILE_M = (0.039, 0.039)  # mirrors of 40 mm and less are what is made
TILE_GAP_M = 0.001
TILE_TILT_DEG = 0.15  # one standard deviation, from uneven adhesive
SUNK_M = 0.02  # by which the panel reaches below z = 0


def mirror_panel(
    size_m: tuple[float, float],
    proud_m: float,
    seed: int,
    clear: tuple[float, float, float] | None = None,
) -> tuple[trimesh.Trimesh, trimesh.Trimesh]:
    """Return a panel about the origin facing +z, and the mirrors on it.

    Parameters
    ----------
    size_m : (float, float), m
        Along x and y.
    proud_m : float, m
        Height of the panel's face.
    seed : int
        Of the mirrors' tilts.
    clear : (float, float, float) or None, m
        (x, y, radius) of a place with no mirrors.
    """
    size = np.array(size_m)
    panel = box((*size, proud_m + SUNK_M), (0.0, 0.0, 0.5 * proud_m - 0.5 * SUNK_M))
    pitch = np.array(TILE_M) + TILE_GAP_M
    counts = np.floor((size - 0.03) / pitch).astype(int)
    axes = [(np.arange(n) - 0.5 * (n - 1)) * step for n, step in zip(counts, pitch, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    if clear is not None:
        grid = grid[np.linalg.norm(grid - np.array(clear[:2]), axis=1) > clear[2]]
    mirrors = tiles(np.column_stack([grid, np.full(len(grid), proud_m + 0.001)]), TILE_M)
    return panel, tilted(mirrors, 4, TILE_TILT_DEG, seed)
