"""Two renders and their difference side by side."""

from __future__ import annotations

from pathlib import Path

import matplotlib.figure as figures
import numpy as np

from models.arrays import Radiance

WHITE_PERCENTILE = 99.0  # of the lit pixels: highlights may saturate
GAMMA = 2.2
DIFFERENCE_RANGE = 0.1  # of white, at the ends of the difference's scale


def save_side_by_side(path: Path, name: str, ours: Radiance, theirs: Radiance) -> None:
    """Save rvbench, Cycles and their difference as one PNG, the first two equally exposed.

    Parameters
    ----------
    path : Path
    name : str
        The Sun's.
    ours, theirs : (height, width) arrays, W m-2 sr-1
    """
    lit = theirs[theirs > 0.0]
    white = float(np.percentile(lit, WHITE_PERCENTILE)) if lit.size else 1.0
    figure = figures.Figure(figsize=(18.0, 6.6), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    for axes, image, title in ((left, ours, "rvbench"), (middle, theirs, "Cycles")):
        shown = np.clip(image / white, 0.0, 1.0) ** (1.0 / GAMMA)
        axes.imshow(shown, cmap="gray", vmin=0.0, vmax=1.0, interpolation="nearest")
        axes.set_title(f"{title}, Sun {name}")
    difference = (ours - theirs) / white
    drawn = right.imshow(
        difference,
        cmap="RdBu",
        vmin=-DIFFERENCE_RANGE,
        vmax=DIFFERENCE_RANGE,
        interpolation="nearest",
    )
    right.set_title(f"rvbench less Cycles, of white ({white:.3g} W m-2 sr-1)")
    figure.colorbar(drawn, ax=right, shrink=0.8)
    for axes in (left, middle, right):
        axes.set_axis_off()
    figure.savefig(path, dpi=110)
