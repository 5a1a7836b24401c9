"""The 17 error states of absolute navigation, by name and place.

Position, velocity and the acceleration that the model leaves out are inertial; the attitude error
is a rotation vector in body axes, ``q_true = q (x) dq(error)``; the clock's bias and drift are kept
in metres and metres per second, for 300 ms are 9e7 m. Where the errors of ranges are known to last,
one more state a channel follows, the error of the satellite that it tracks.
"""

from __future__ import annotations

from dataclasses import dataclass

from models.arrays import Floats

POSITION, VELOCITY, ACCELERATION = slice(0, 3), slice(3, 6), slice(6, 9)
ATTITUDE, GYRO_BIAS, CLOCK = slice(9, 12), slice(12, 15), slice(15, 17)
CLOCK_BIAS, CLOCK_DRIFT = 15, 16
SIZE = 17


@dataclass(eq=False)
class AbsoluteState:
    """Estimates of as many runs as there are.

    Attributes
    ----------
    time_s : float, s
    vector : (runs, n) array
        Of 17 states and those of the channels.
        The places of the attitude error hold zeros.
    q_inertial_from_body_wxyz : (runs, 4) array
    factor : (runs, n, n) array
        S of the covariance ``S S'``.
    """

    time_s: float
    vector: Floats
    q_inertial_from_body_wxyz: Floats
    factor: Floats

    @property
    def covariance(self) -> Floats:
        """(runs, n, n) array."""
        return self.factor @ self.factor.swapaxes(-1, -2)
