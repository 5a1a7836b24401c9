"""A star sensor by its data sheet: unbiased, with a Gaussian error across and about its boresight.

References
----------
VINAG 2018, section 4.2: 5 Hz, 2.5 arcsec across the boresight, 5 arcsec about it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.quaternions import from_rotation_vector, multiplied

ARCSEC = np.deg2rad(1.0 / 3600.0)


@dataclass(frozen=True)
class StarSensor:
    """A star sensor.

    Attributes
    ----------
    rate_hz : float, Hz
    across_arcsec, about_arcsec : float, arcsec
        1 sigma on each of two axes across the boresight, and about it.
    boresight_in_body : (float, float, float)
        Unit vector.
    """

    rate_hz: float = 5.0
    across_arcsec: float = 2.5
    about_arcsec: float = 5.0
    boresight_in_body: tuple[float, float, float] = (0.0, -1.0, 0.0)

    @property
    def covariance_rad2(self) -> Floats:
        """(3, 3) array, rad2, body axes."""
        along = np.outer(self.boresight_in_body, self.boresight_in_body)
        across, about = (self.across_arcsec * ARCSEC) ** 2, (self.about_arcsec * ARCSEC) ** 2
        return across * (np.eye(3) - along) + about * along

    def measured(self, q_inertial_from_body_wxyz: Floats, draws: Floats) -> Floats:
        """Return attitudes with errors, (..., 4).

        Parameters
        ----------
        q_inertial_from_body_wxyz : (..., 4) array
            True.
        draws : (..., 3) array
            Standard normal.
        """
        errors = draws @ np.linalg.cholesky(self.covariance_rad2).T
        return multiplied(q_inertial_from_body_wxyz, from_rotation_vector(errors))
