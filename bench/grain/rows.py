"""The frames in which grain is counted, and the places of each that have a reference."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from models.arrays import AnyArray, Mask
from renders.scenario.scenario import RenderRequest, Scenario, resolve
from renders.world.build import world_of
from renders.world.exposure import Exposure
from renders.world.world import World

WIDTH_PX = 512
TILE_PX = 32
TILES = 16  # of a frame: a sixteenth of it
LEAST_SEEN = 0.3  # of a tile's pixels that show a spacecraft
TILE_SEED = 7


@dataclass(frozen=True)
class Row:
    """One frame of a case.

    Attributes
    ----------
    case : str
    sun : str
        As ``--sun`` takes it.
    time_s : float, s
        Near which its exposure lies.
    allowed : (3,) tuple of float
        Share of lit pixels whose noise may lie above 1, 3 and 10 sigma of the detector's.
    """

    case: str
    sun: str
    time_s: float
    allowed: tuple[float, float, float] = (1e-2, 1e-3, 1e-5)

    @property
    def name(self) -> str:
        """What its file and its line are called by."""
        sun = self.sun if self.sun.startswith("S") else "own"
        return f"{self.case}_{sun}_{self.time_s:g}s"


BEHIND = "0.45,-0.75,-0.48"
MAXAR_SUNS = ("S2", "S3", "S7", BEHIND)
MAXAR_TIMES_S = (20.0, 240.0, 300.0)
OF_THE_TABLE = ((240.0, "S2"), (240.0, "S3"), (20.0, "S7"), (20.0, BEHIND))
# A tumble's Sun turns over the target: no light is shared between its images, and each is paid for.
TUMBLE_ALLOWED = (8e-2, 1e-2, 1e-3)
TUMBLES = (
    Row("xmm-tumble", "0.86,0.38,0.33", 100.0, TUMBLE_ALLOWED),
    Row("hispasat-tumble", "-0.2,-0.66,-0.72", 100.0, TUMBLE_ALLOWED),
)
TABLE = (*(Row("maxar-approach", sun, time_s) for time_s, sun in OF_THE_TABLE), *TUMBLES)
REFERENCED = (
    *(Row("maxar-approach", sun, time_s) for time_s in MAXAR_TIMES_S for sun in MAXAR_SUNS),
    *TUMBLES,
)


@dataclass(frozen=True, eq=False)
class Place:
    """A row's world, with one Sun, and which of its exposures is looked at."""

    world: World
    exposure: Exposure

    @classmethod
    def of(cls, row: Row, render: dict[str, object]) -> Place:
        """Return where a row's light is traced.

        Parameters
        ----------
        row : Row
        render : dict
            Keys of ``[render]`` that differ from the case's.
        """
        scenario = resolve(RenderRequest(row.case, Path(), sun=row.sun, width=WIDTH_PX))
        world = world_of(_with(scenario, render))
        band = world.bands[-1]
        times = {e: abs(e.time_s - row.time_s) for e in world.exposures if e.band == band}
        return cls(world, min(times, key=times.__getitem__))


def _with(scenario: Scenario, render: dict[str, object]) -> Scenario:
    table = scenario.model_dump()
    table["render"].update(render)
    table["sun"].update(shared=[])
    return Scenario(**table)


def tiles_of(seen: Mask) -> AnyArray:
    """Choose places of a frame by chance among those that show something.

    Parameters
    ----------
    seen : (height, width) array of bool
        Pixels that show a spacecraft.

    Returns
    -------
    (n, 2) array of int
        Row and column of each tile's first pixel, in order.
    """
    down, across = (n // TILE_PX for n in seen.shape)
    cut = seen[: down * TILE_PX, : across * TILE_PX]
    share = cut.reshape(down, TILE_PX, across, TILE_PX).mean(axis=(1, 3))
    there = np.argwhere(share >= LEAST_SEEN)
    rng = np.random.default_rng(TILE_SEED)
    chosen = rng.choice(len(there), min(TILES, len(there)), replace=False)
    return np.asarray(TILE_PX * there[np.sort(chosen)])


def pixels_of(tiles: AnyArray, width: int) -> AnyArray:
    """Return the pixels of tiles, (n, TILE_PX, TILE_PX) uint32, ``row * width + column``."""
    step = np.arange(TILE_PX)
    rows = tiles[:, 0, None, None] + step[None, :, None]
    columns = tiles[:, 1, None, None] + step[None, None, :]
    return np.asarray(rows * width + columns, dtype=np.uint32)
