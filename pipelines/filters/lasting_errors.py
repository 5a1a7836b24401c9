"""Errors of measured poses that last: as long as a view does, or for ever.

What a drawing leaves out, and where light shows an edge that is none, shifts a pose alike from
image to image, until the target has turned on. Of a measured pose's covariance C a share is drawn
anew for every image; a share belongs to the view, and fades as the target turns; a share stays,

    error = v + sqrt(view) L b_view + sqrt(steady) L b_steady,    C = L L',

b being errors in sigmas, three numbers each of unit variance, which the filter carries beside its
state. They are told from motion only as far as the motion is smoother; the rest stays in the
state's covariance, which white errors of the same size would have made shrink.

Source: a first-order Gauss-Markov process (Gelb, Applied Optimal Estimation, 1974, section 3.6)
in turned angle rather than in time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.errors import ScenarioError


@dataclass(frozen=True)
class LastingErrors:
    """How a measured pose's errors are shared out; without arguments they are white.

    Attributes
    ----------
    view_share, steady_share : float
        Of the stated covariance; what is left is drawn anew for every image.
    view_turn_deg : float, deg
        Turn of the target before the camera over which a view's error falls to 1/e.
    """

    view_share: float = 0.0
    steady_share: float = 0.0
    view_turn_deg: float = 20.0

    def __post_init__(self) -> None:
        shares = (self.view_share, self.steady_share)
        if not (min(shares) >= 0.0 and sum(shares) < 1.0 and self.view_turn_deg > 0.0):
            raise ScenarioError(
                "lasting errors: expected view_share and steady_share of at least 0 and together "
                f"below 1, and view_turn_deg above 0, got {self.view_share}, {self.steady_share} "
                f"and {self.view_turn_deg}"
            )

    @property
    def lasting_share(self) -> float:
        """Of the covariance, what is not drawn anew."""
        return self.view_share + self.steady_share

    @property
    def count(self) -> int:
        """n, the numbers that a filter of three measured ones carries beside its state."""
        return 6 if self.lasting_share else 0

    def effect(self, covariance: Floats) -> Floats:
        """Return how the n numbers carried show in a measurement, (3, n).

        Parameters
        ----------
        covariance : (3, 3) array
            Of the measured pose's position, or of its turn. Its symmetric root is taken, so that
            an error keeps its direction while the covariance changes a little.
        """
        if not self.count:
            return np.zeros((3, 0))
        values, vectors = np.linalg.eigh(covariance)
        root = (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
        return np.hstack([np.sqrt(self.view_share) * root, np.sqrt(self.steady_share) * root])

    def begun(self, covariance: Floats, effect: Floats) -> Floats:
        """Return the (6 + n, 6 + n) covariance of a state begun from a pose, and of its errors.

        Parameters
        ----------
        covariance : (6, 6) array
            Of the state; the pose's own in its first three rows.
        effect : (3, n) array
            See ``effect``; of zeros where the state comes from elsewhere.
        """
        joint = np.eye(6 + self.count)
        joint[:6, :6] = covariance
        joint[:3, 6:], joint[6:, :3] = -effect, -effect.T
        return joint

    def carried(
        self, transition: Floats, noise: Floats, turned_rad: float
    ) -> tuple[Floats, Floats]:
        """Return transition and process noise of state and errors, (6 + n, 6 + n) both.

        Parameters
        ----------
        transition, noise : (6, 6) arrays
            Of the state alone.
        turned_rad : float, rad
            What the target has turned before the camera.
        """
        if not self.count:
            return transition, noise
        kept = float(np.exp(-turned_rad / np.deg2rad(self.view_turn_deg)))
        flow, spread = np.eye(12), np.zeros((12, 12))
        flow[:6, :6], spread[:6, :6] = transition, noise
        flow[6:9, 6:9] *= kept
        spread[6:9, 6:9] = (1.0 - kept**2) * np.eye(3)
        return flow, spread


WHITE = LastingErrors()
