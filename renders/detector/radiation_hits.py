"""Energetic particles through the chip: straight tracks of charge, added before wells run over.

A particle crosses the chip's sensitive silicon on a straight line and leaves charge evenly along
it. Directions are isotropic, so those that cross a surface follow Lambert's law and the mean path
is twice the thickness (Cauchy). Galactic particles outside the magnetosphere, as at GEO: about
5 /cm2/s at solar minimum and 2 at maximum, some 3000 in a great flare (Robberto 2009,
JWST-STScI-001928). A minimum-ionising particle leaves 388 eV/um in the mean (Particle Data Group),
at 3.66 eV a pair 106 e/um; slow protons and ions leave tens to thousands of times that.

Left out: the straggling of that charge (Landau), its diffusion to neighbouring pixels, and what
hits the chip while it is read out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.sensors.camera_chip import Detector, Radiation

RADIATION_DRAW = 103  # keys its random numbers apart from the noise's


@dataclass(frozen=True, eq=False)
class Tracks:
    """Where particles cross the sensitive silicon.

    Attributes
    ----------
    start_px : (n, 2) array, px
        Column and row where each enters; pixel centres are integers.
    run_px : (n, 2) array, px
        From there to where it would leave the silicon's far side.
    charge_e : (n,) array, e
        On the whole way, whether the chip is under all of it or not.
    """

    start_px: Floats
    run_px: Floats
    charge_e: Floats


def radiation_hits(
    radiation: Radiation,
    detector: Detector,
    shape: tuple[int, int],
    exposure_ms: float,
    key: tuple[int, ...],
) -> Floats | None:
    """Return the charge that particles leave in one exposure; None if none fly.

    Parameters
    ----------
    radiation : Radiation
    detector : Detector
    shape : (int, int), px
        Height and width of the image.
    exposure_ms : float, ms
    key : tuple of int
        (run, frame, band), and the case's own seed if it has one; the noise of the exposure is
        drawn apart and stays as it was.

    Returns
    -------
    (height, width) array, e, or None
    """
    if radiation.flux_cm2_s <= 0.0:
        return None
    rng = np.random.default_rng(np.random.SeedSequence([*key, RADIATION_DRAW]))
    return deposit(draw_tracks(radiation, detector, shape, exposure_ms, rng), shape)


def draw_tracks(
    radiation: Radiation,
    detector: Detector,
    shape: tuple[int, int],
    exposure_ms: float,
    rng: np.random.Generator,
) -> Tracks:
    """Draw the particles of one exposure.

    Parameters
    ----------
    radiation : Radiation
    detector : Detector
    shape : (int, int)
        Rows and columns of the chip.
    exposure_ms : float, ms
    rng : numpy Generator
    """
    height, width = shape
    area_cm2 = height * width * (detector.pixel_pitch_um * 1e-4) ** 2
    count = rng.poisson(radiation.flux_cm2_s * area_cm2 * exposure_ms * 1e-3)
    start = rng.random((count, 2)) * (width, height) - 0.5
    cosine = np.sqrt(1.0 - rng.random(count))  # Lambert: its square is even from 0 to 1
    azimuth = 2.0 * np.pi * rng.random(count)
    aside = np.sqrt(1.0 - cosine**2) / cosine * (radiation.depth_um / detector.pixel_pitch_um)
    return Tracks(
        start_px=start,
        run_px=aside[:, None] * np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1),
        charge_e=radiation.charge_e_um * radiation.depth_um / cosine,
    )


def deposit(tracks: Tracks, shape: tuple[int, int]) -> Floats:
    """Return the charge that tracks leave in each pixel, (height, width), e.

    Each pixel gets its share of a track's length, exactly; what lies beyond the border is lost.
    """
    charge = np.zeros(shape)
    rows = zip(tracks.start_px, tracks.run_px, tracks.charge_e, strict=True)
    for start, run, total in rows:
        columns_rows, shares = _crossed(start, run, shape)
        np.add.at(charge, (columns_rows[:, 1], columns_rows[:, 0]), total * shares)
    return charge


def _crossed(
    start: Floats, run: Floats, shape: tuple[int, int]
) -> tuple[np.ndarray[tuple[int, int], np.dtype[np.int64]], Floats]:
    """Return the pixels under a track, as column and row, and the share of its length in each."""
    size = np.array(shape[::-1], dtype=np.float64)
    edge = np.where(run > 0.0, size - 0.5, -0.5)
    moves = np.abs(run) > 1e-12
    leaves = np.divide(edge - start, run, out=np.full(2, np.inf), where=moves).min()
    end = min(1.0, float(leaves))
    cuts = [np.array([0.0, end])]
    for axis in np.flatnonzero(moves):
        low, high = sorted((start[axis], start[axis] + end * run[axis]))
        borders = np.arange(np.ceil(low - 0.5), np.floor(high - 0.5) + 1.0) + 0.5
        cuts.append((borders - start[axis]) / run[axis])
    along = np.sort(np.clip(np.concatenate(cuts), 0.0, end))
    middles = start + 0.5 * (along[1:] + along[:-1])[:, None] * run
    inside = np.clip(np.rint(middles), 0.0, size - 1.0)
    return inside.astype(np.int64), np.diff(along)
