"""From the noise of a few samples to how many a pixel needs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import AnyArray, Floats

LEAST = 4  # samples of a pixel
MOST_SHARE = 64.0  # times the inverse square of the limit: a pixel that asks for more stays noisier
SPREAD = 2.9  # samples spread evenly err by so much less than the law below has it (measured)


@dataclass(frozen=True, eq=False)
class Moments:
    """What a few samples tell of pixels.

    Attributes
    ----------
    mean : (n,) array, W m-2 sr-1
    straight_deviation, bounced_deviation : (n,) arrays, W m-2 sr-1
        1 sigma of one sample: of the light that comes straight to what is seen, and of all other.
    """

    mean: Floats
    straight_deviation: Floats
    bounced_deviation: Floats


@dataclass(frozen=True)
class NoiseLimit:
    """How much Monte-Carlo noise a pixel may have, in units of the detector's.

    The detector's own 1 sigma is ``sqrt(shot^2 + read^2 + (1 % of the signal)^2)`` at the longest
    exposure that the light is for.

    Attributes
    ----------
    share : float
        Of it, rms.
    electrons_per_radiance : float, e per W m-2 sr-1
        At that exposure.
    read_noise_e, full_well_e : float, e
    """

    share: float
    electrons_per_radiance: float
    read_noise_e: float
    full_well_e: float

    def wanted(self, pilot: Moments) -> AnyArray:
        """Return how many samples pixels need, a power of two.

        Light that comes straight changes at outlines, on which samples are spread evenly: what is
        left of its error falls as the power -3/4 of their number. All other light is drawn by
        chance: -1/2.

        Parameters
        ----------
        pilot : Moments

        Returns
        -------
        (n,) uint32 array
        """
        scale = self.electrons_per_radiance
        signal = pilot.mean * scale
        limit = self.share * np.sqrt(signal + self.read_noise_e**2 + (0.01 * signal) ** 2)
        straight = (pilot.straight_deviation * scale / (SPREAD * limit)) ** (4.0 / 3.0)
        bounced = (pilot.bounced_deviation * scale / limit) ** 2
        count = np.clip(straight + bounced, LEAST, max(LEAST, MOST_SHARE / self.share**2))
        full = signal - 3.0 * pilot.straight_deviation * scale > self.full_well_e
        return np.where(full, LEAST, 2.0 ** np.ceil(np.log2(count))).astype(np.uint32)
