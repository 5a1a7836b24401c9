"""How far a frame is from its reference, in units of the detector's own noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import AnyArray, Floats

SIGMAS = (1.0, 3.0, 10.0)
UNIFORMITY = 0.01  # of the signal: what no calibration of a chip knows better


@dataclass(frozen=True)
class Detector:
    """What a chip adds to light.

    Attributes
    ----------
    read_noise_e, full_well_e : float, e
    """

    read_noise_e: float
    full_well_e: float

    def sigma_e(self, signal_e: Floats) -> Floats:
        """Return its 1-sigma noise, e.

        Parameters
        ----------
        signal_e : (...,) array, e

        Returns
        -------
        (...,) array, e
        """
        return np.sqrt(signal_e + self.read_noise_e**2 + (UNIFORMITY * signal_e) ** 2)


@dataclass(frozen=True)
class Grain:
    """What one frame shows that is not there.

    Attributes
    ----------
    above : (3,) tuple of float
        Share of lit pixels further from the reference than 1, 3 and 10 sigma.
    rms : float
        Over the lit pixels, in sigmas.
    lit : int
        Pixels whose signal exceeds the read noise.
    frame_bias : float
        Mean of all over the reference's, less one.
    worst_tile : float
        The largest such of one tile.
    """

    above: tuple[float, ...]
    rms: float
    lit: int
    frame_bias: float
    worst_tile: float


def grain(frame_e: Floats, reference_e: AnyArray, detector: Detector) -> Grain:
    """Compare tiles of a frame with the reference's.

    Parameters
    ----------
    frame_e, reference_e : (n, height, width) arrays, e
    detector : Detector
    """
    frame, truth = (
        np.minimum(np.asarray(each, dtype=np.float64), detector.full_well_e)
        for each in (frame_e, reference_e)
    )
    lit = truth > detector.read_noise_e
    off = ((frame - truth) / detector.sigma_e(truth))[lit]
    of_tile, true_of_tile = frame.mean(axis=(1, 2)), truth.mean(axis=(1, 2))
    told = true_of_tile > detector.read_noise_e
    bias = of_tile[told] / true_of_tile[told] - 1.0
    return Grain(
        above=tuple(float((np.abs(off) > sigma).mean()) for sigma in SIGMAS),
        rms=float(np.sqrt((off**2).mean())),
        lit=int(lit.sum()),
        frame_bias=float(frame.sum() / truth.sum() - 1.0),
        worst_tile=float(bias[np.argmax(np.abs(bias))]),
    )
