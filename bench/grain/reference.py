"""References of grain: tiles of frames, path-traced until their own noise is nothing.

``python -P -m bench.grain.reference`` makes them anew, a quarter of an hour of a core;
whatever changes the physics of light makes it due. They are kept beside the papers' tables.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.grain.rows import REFERENCED, Place, Row, tiles_of
from models.arrays import AnyArray, Floats
from models.atomic_file import write_bytes
from models.errors import RvbenchError
from renders.store.light_keys import PHYSICS_VERSION

FOLDER = Path(__file__).resolve().parents[1] / "reference" / "grain"
SAMPLES = 4096
SEED = 16_000
BITS = 12  # of an electron count's mantissa that are kept: 0.02 %


@dataclass(frozen=True, eq=False)
class Reference:
    """Tiles of one frame.

    Attributes
    ----------
    tiles : (n, 2) int array
        Row and column of each one's first pixel.
    electrons : (n, TILE_PX, TILE_PX) float32 array, e
    physics : int
        ``PHYSICS_VERSION`` of the code that traced it.
    samples : int
    """

    tiles: AnyArray
    electrons: AnyArray
    physics: int
    samples: int

    @classmethod
    def read(cls, row: Row, folder: Path = FOLDER) -> Reference:
        """Return a row's.

        Parameters
        ----------
        row : Row
        folder : Path
            That holds them.

        Raises
        ------
        RvbenchError
            If there is none, or it is of other light.
        """
        path = folder / f"{row.name}.npz"
        again = "python -P -m bench.grain.reference makes them"
        if not path.is_file():
            raise RvbenchError(f"expected a reference in {path}, found none; {again}")
        with np.load(path) as kept:
            made = cls(
                kept["tiles"].astype(np.int64),
                kept["electrons"],
                int(kept["physics"]),
                int(kept["samples"]),
            )
        if made.physics != PHYSICS_VERSION:
            raise RvbenchError(
                f"expected {path} of physics {PHYSICS_VERSION}, got {made.physics}; {again}"
            )
        return made

    def write(self, row: Row, folder: Path = FOLDER) -> None:
        """Keep it, rounded to ``BITS``.

        Parameters
        ----------
        row : Row
        folder : Path
            That holds them.
        """
        from io import BytesIO

        made = BytesIO()
        np.savez_compressed(
            made,
            tiles=self.tiles.astype(np.uint16),
            electrons=rounded(self.electrons),
            physics=self.physics,
            samples=self.samples,
        )
        write_bytes(folder / f"{row.name}.npz", made.getvalue())


def rounded(values: Floats) -> AnyArray:
    """Return numbers of ``BITS`` binary digits, which compress well.

    Parameters
    ----------
    values : (...,) array

    Returns
    -------
    (...,) float32 array
    """
    mantissa, exponent = np.frexp(values)
    return np.ldexp(np.round(mantissa * 2.0**BITS) / 2.0**BITS, exponent).astype(np.float32)


def _make(row: Row, folder: Path, samples: int) -> None:
    """Trace a row's reference and keep it."""
    from bench.grain.light import path_traced, seen

    place = Place.of(row, {})
    tiles = tiles_of(seen(place))
    traced = path_traced(place, tiles, samples, SEED)
    Reference(tiles, traced, PHYSICS_VERSION, samples).write(row, folder)


def main() -> int:
    """Make all references, or those named."""
    from renders.batches.studio import start_renderer
    from renders.variant.choice import choose_variant

    parser = argparse.ArgumentParser(prog="python -P -m bench.grain.reference", description=__doc__)
    parser.add_argument("--samples", type=int, default=SAMPLES, help="of each pixel")
    parser.add_argument("--folder", type=Path, default=FOLDER, help="where they are kept")
    parser.add_argument("--rows", nargs="*", help="names of rows; all unless given")
    asked = parser.parse_args()
    start_renderer(choose_variant("auto"), None)
    asked.folder.mkdir(parents=True, exist_ok=True)
    for row in REFERENCED:
        if asked.rows is None or row.name in asked.rows:
            _make(row, asked.folder, asked.samples)
            print(row.name, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
