"""What an absolute navigator gets: GNSS epochs, gyroscope intervals and star attitudes.

Every record is of one instant of as many *runs* as one likes: simulations of one flight that differ
by their noise. A flight computer has one run. A star attitude carries its own covariance, so that
it may come from a parametric sensor or from a camera that sees stars.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from models.arrays import Floats, Indices
from models.errors import DatasetError


@dataclass(frozen=True, eq=False)
class GnssEpoch:
    """Pseudoranges and range rates of one instant.

    Attributes
    ----------
    time_s : float, s
    satellite : (m,) int array
        Numbers that stay with the satellites.
    sent_from_m, sent_at_m_s : (m, 3) array, m and m/s
        Inertial places and velocities of the satellites at transmission, by their ephemerides.
    cn0_dbhz : (m,) array, dB-Hz
    pseudorange_m, range_rate_m_s : (runs, m) array, m and m/s
        Corrected for all that the satellite tells of; the receiver's clock is still in them.

    Raises
    ------
    DatasetError
        If the shapes do not belong together.
    """

    time_s: float
    satellite: Indices
    sent_from_m: Floats
    sent_at_m_s: Floats
    cn0_dbhz: Floats
    pseudorange_m: Floats
    range_rate_m_s: Floats

    def __post_init__(self) -> None:
        count = len(self.satellite)
        runs = len(self.pseudorange_m)
        expected = [(count, 3), (count, 3), (count,), (runs, count), (runs, count)]
        arrays = (self.sent_from_m, self.sent_at_m_s, self.cn0_dbhz)
        got = [each.shape for each in (*arrays, self.pseudorange_m, self.range_rate_m_s)]
        if got != expected:
            raise DatasetError(
                f"GNSS at {self.time_s} s: expected arrays of shapes {expected} for {count} "
                f"satellites, got {got}"
            )


@dataclass(frozen=True, eq=False)
class InertialInterval:
    """What the inertial unit measured since the record before it.

    Attributes
    ----------
    time_s : float, s
        End of the interval.
    duration_s : float, s
    turn_rad : (runs, 3) array, rad
        Rotation vector from the body's axes at the start to those at the end, body axes: the
        gyroscopes' samples, summed with their coning.
    specific_force_m_s2 : (runs, 3) array or None, m/s2
        Mean of the accelerometers in body axes; None where the satellite coasts.
    """

    time_s: float
    duration_s: float
    turn_rad: Floats
    specific_force_m_s2: Floats | None = None


@dataclass(frozen=True, eq=False)
class StarAttitude:
    """An attitude among the stars.

    Attributes
    ----------
    time_s : float, s
    q_inertial_from_body_wxyz : (runs, 4) array
    covariance_rad2 : (3, 3) or (runs, 3, 3) array, rad2
        Of the rotation vector, in body axes, that carries the truth to the measurement.
    """

    time_s: float
    q_inertial_from_body_wxyz: Floats
    covariance_rad2: Floats


NavigationRecord: TypeAlias = GnssEpoch | InertialInterval | StarAttitude


def coned_turn(increments_rad: Floats) -> Floats:
    """Return one rotation vector of gyroscope increments that follow one another, (..., 3), rad.

    Parameters
    ----------
    increments_rad : (..., n, 3) array, rad
        Turns between samples, each in the body axes of its start. The sum is corrected to second
        order for the turning of those axes (Magnus): what is left is of the third, some 1e-9 rad
        over 0.2 s of coning at a degree per second.
    """
    before = np.cumsum(increments_rad, axis=-2) - increments_rad
    return np.sum(increments_rad + 0.5 * np.cross(before, increments_rad), axis=-2)
