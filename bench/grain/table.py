"""``make grain``: noise and bias of frames against references, by a case's samples and quieter.

Each frame is traced with a seed of its own, its baked light too, and held against tiles that were
path-traced with 4096 samples a pixel. Times are processor time of light alone, bakes apart.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
from rich.table import Table

from bench.grain.count import Detector, Grain, grain
from bench.grain.reference import FOLDER, Reference
from bench.grain.rows import REFERENCED, TABLE, Place, Row, pixels_of
from models.errors import RvbenchError
from models.plain_console import plain_console

FRAME_SEED = 1_000_003  # far from the references'
PATHS = 2**22
COLUMNS = ("frame", "way", ">1 σ %", ">3 σ %", ">10 σ %", "rms σ", "frame", "tile", "s", "bake s")
WAYS: dict[str, dict[str, object]] = {
    "the case": {},
    "and paths": {"paths": PATHS},
    "noise 1": {"noise": 1.0, "paths": PATHS},
    "noise 0.5": {"noise": 0.5, "paths": PATHS},
}


def measured(
    row: Row, render: dict[str, object], folder: Path = FOLDER
) -> tuple[Grain, float, float]:
    """Trace a row's frame and count its grain.

    Parameters
    ----------
    row : Row
    render : dict
        Keys of ``[render]`` that differ from the case's.
    folder : Path
        Of the references.

    Returns
    -------
    Grain, and processor time of its bake and of its light, s.
    """
    from bench.grain.light import traced

    reference = Reference.read(row, folder)
    place = Place.of(row, {"seed": FRAME_SEED, **render})
    found = traced(place)
    chip = place.world.scenario.simulated_detector
    pixels = pixels_of(reference.tiles, place.world.camera.width)
    counted = grain(
        found.electrons.ravel()[pixels],
        reference.electrons,
        Detector(chip.read_noise_e, chip.full_well_e),
    )
    return counted, max(0.0, found.bake_s - found.light_s), found.light_s


def holds(row: Row, found: Grain) -> bool:
    """Tell whether a row's grain is within what is allowed."""
    return all(share <= most for share, most in zip(found.above, row.allowed, strict=True))


def main() -> int:
    """Print the table; 1 if the last way shows more grain than is allowed, 2 if none was made."""
    from renders.batches.studio import start_renderer
    from renders.variant.choice import choose_variant

    parser = argparse.ArgumentParser(prog="make grain", description=__doc__)
    parser.add_argument("--every", action="store_true", help="all rows that have a reference")
    parser.add_argument("--rows", nargs="*", help="names of rows")
    parser.add_argument("--ways", nargs="*", choices=list(WAYS), default=list(WAYS))
    parser.add_argument("--seed", type=int, default=FRAME_SEED, help="of frames and of paths")
    parser.add_argument("--references", type=Path, default=FOLDER, help="their folder")
    asked = parser.parse_args()
    console = plain_console()
    start_renderer(choose_variant("auto"), None)
    table = Table(*COLUMNS)
    missed = 0
    for row in REFERENCED if asked.every else TABLE:
        if asked.rows is not None and row.name not in asked.rows:
            continue
        try:
            for name in asked.ways:
                render = {**WAYS[name], "seed": asked.seed}
                found, bake_s, light_s = measured(row, render, asked.references)
                table.add_row(*_cells(row, name, found, bake_s, light_s))
            missed += not holds(row, found)
        except RvbenchError as error:
            console.print(f"{error}", style="red", markup=False)
            return 2
    console.print(table)
    return int(missed > 0)


def _cells(row: Row, name: str, found: Grain, bake_s: float, light_s: float) -> list[str]:
    """Return one line of the table: shares in percent, biases in percent, times in seconds."""
    shares = [f"{100.0 * share:.3g}" for share in found.above]
    biases = [f"{100.0 * bias:+.2f} %" for bias in (found.frame_bias, found.worst_tile)]
    rms = f"{found.rms:.2f}"
    return [row.name, name, *shares, rms, *biases, f"{light_s:.2f}", f"{np.round(bake_s, 1)}"]


if __name__ == "__main__":
    sys.exit(main())
