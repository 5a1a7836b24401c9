"""How a three-axis stabilised target sways about its nominal attitude: slowly and not far."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats

SINUSOIDS = 3  # an axis: enough not to look periodic within one approach
PERIODS_S = (400.0, 1600.0)  # slow enough for a degree at 0.02 deg/s
BIAS_SHARE = 0.25  # of the pointing accuracy is a constant offset, the rest sways


@dataclass(frozen=True, eq=False)
class AttitudeWobble:
    """A sum of slow sinusoids on each axis, as a rotation vector.

    Attributes
    ----------
    bias_deg : (3,) array, deg
        Constant part.
    amplitude_deg, period_s, phase_rad : (3, k) arrays
        One row an axis.
    """

    bias_deg: Floats
    amplitude_deg: Floats
    period_s: Floats
    phase_rad: Floats

    @classmethod
    def drawn(cls, accuracy_deg: float, max_rate_deg_s: float, seed: int) -> AttitudeWobble:
        """Draw one that never exceeds ``accuracy_deg`` on any axis nor ``max_rate_deg_s`` in all.

        Both bounds hold for all time: the amplitudes are scaled until even all sinusoids of an
        axis at their peaks stay within them. The turn's angular rate is never more than the rate
        of its rotation vector, so bounding the latter on each axis bounds the former.

        Parameters
        ----------
        accuracy_deg : float, deg
        max_rate_deg_s : float, deg/s
        seed : int
            The same seed draws the same wobble.

        Raises
        ------
        ValueError
            If a bound is negative or not finite.
        """
        for name, value in (("accuracy_deg", accuracy_deg), ("max_rate_deg_s", max_rate_deg_s)):
            if not 0.0 <= value < np.inf:
                raise ValueError(f"expected a finite {name} of at least zero, got {value}")
        rng = np.random.default_rng(seed)
        shape = (3, SINUSOIDS)
        period_s = np.exp(rng.uniform(np.log(PERIODS_S[0]), np.log(PERIODS_S[1]), size=shape))
        share = rng.uniform(0.3, 1.0, size=shape) * period_s  # the slower, the further
        swing_deg = share * (1.0 - BIAS_SHARE) * accuracy_deg / share.sum(axis=1, keepdims=True)
        rate_deg_s = (2.0 * np.pi * swing_deg / period_s).sum(axis=1, keepdims=True)
        allowed = max_rate_deg_s / np.sqrt(3.0)
        scale = np.minimum(1.0, allowed / np.maximum(rate_deg_s, 1e-300))
        return cls(
            bias_deg=rng.uniform(-1.0, 1.0, size=3) * BIAS_SHARE * accuracy_deg,
            amplitude_deg=swing_deg * scale,
            period_s=period_s,
            phase_rad=rng.uniform(0.0, 2.0 * np.pi, size=shape),
        )

    def rotation_vector_deg(self, time_s: float) -> Floats:
        """Return the (3,) rotation vector, deg, in the nominal target axes."""
        angle = 2.0 * np.pi * time_s / self.period_s + self.phase_rad
        return self.bias_deg + (self.amplitude_deg * np.sin(angle)).sum(axis=1)

    def nominal_from_target(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation from target axes to the nominal ones."""
        return Rotation.from_rotvec(self.rotation_vector_deg(time_s), degrees=True).as_matrix()
