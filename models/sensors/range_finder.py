"""A range finder: one distance along the boresight, with noise, wrong echoes and none at all."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.errors import ScenarioError

RANGE_COLUMNS = ("range_m", "sigma_m")
"""Of its stream: what is read along the boresight, and the 1 sigma of a right echo."""


@dataclass(frozen=True)
class RangeFinder:
    """What a range finder adds to a true distance.

    Attributes
    ----------
    sigma_m : float, m
        1 sigma of a right echo.
    rate_hz : float, Hz
        Readings; at most one a frame is used.
    outlier_share : float
        Of the readings, echoes of something else: uniform within ``outlier_span_m`` either way.
    outlier_span_m : float, m
    drop_out_share : float
        Of the readings that do not come.

    Raises
    ------
    ScenarioError
        If a value is out of range.
    """

    sigma_m: float = 0.01
    rate_hz: float = 1.0
    outlier_share: float = 0.0
    outlier_span_m: float = 10.0
    drop_out_share: float = 0.0

    def __post_init__(self) -> None:
        for name in ("sigma_m", "rate_hz", "outlier_span_m"):
            if not 0.0 < getattr(self, name) < np.inf:
                raise ScenarioError(
                    f"range finder: expected {name} above zero, got {getattr(self, name)}"
                )
        for name in ("outlier_share", "drop_out_share"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise ScenarioError(
                    f"range finder: expected {name} from 0 to 1, got {getattr(self, name)}"
                )

    def due(self, frame: int, frame_rate_hz: float) -> bool:
        """Tell whether a frame comes with a reading: the first frame does.

        Parameters
        ----------
        frame : int
        frame_rate_hz : float, Hz
        """
        ratio = min(1.0, self.rate_hz / frame_rate_hz)
        return frame == 0 or int(frame * ratio) != int((frame - 1) * ratio)

    def reading(self, true_m: float, draw: np.random.Generator) -> float | None:
        """Return what is read of a distance, m, or None.

        The same numbers are drawn whatever comes of them, so that one share leaves the others'
        draws alone.

        Parameters
        ----------
        true_m : float, m
            To the surface that the beam meets; not finite where it meets none.
        draw : numpy Generator
        """
        noise, wrong, lost, where = (*draw.standard_normal(1), *draw.uniform(size=3))
        if lost < self.drop_out_share or not np.isfinite(true_m):
            return None
        if wrong < self.outlier_share:
            return max(0.0, true_m + self.outlier_span_m * (2.0 * float(where) - 1.0))
        return true_m + self.sigma_m * float(noise)
