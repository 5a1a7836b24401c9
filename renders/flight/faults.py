"""What may go wrong with the sensors, and is to be detected, told of, and survived."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from models.navigation_records import GnssEpoch, StarAttitude
from models.quaternions import from_rotation_vector, multiplied


@dataclass(frozen=True)
class Faults:
    """Faults of a flight; none unless told.

    Attributes
    ----------
    liar : int
        Number of a satellite whose ranges are off; -1 for none.
    lie_m, lie_start_s, lie_end_s : float, m and s
    gap_start_s, gap_end_s : float, s
        Without GNSS.
    swapped_s : float, s
        From when star frames are of another part of the sky.
    swapped_frames : int
        So many of them.
    swapped_deg : float, deg
        By how far the attitude is off then, about an oblique axis.
    """

    liar: int = -1
    lie_m: float = 0.0
    lie_start_s: float = 0.0
    lie_end_s: float = np.inf
    gap_start_s: float = np.inf
    gap_end_s: float = np.inf
    swapped_s: float = np.inf
    swapped_frames: int = 0
    swapped_deg: float = 0.0

    @property
    def start_s(self) -> float:
        """When the first of them begins, s."""
        lie_s = self.lie_start_s if self.lie_m else np.inf
        return min(lie_s, self.gap_start_s, self.swapped_s)

    def of_epoch(self, epoch: GnssEpoch) -> GnssEpoch | None:
        """Return what the receiver gives instead; None in a gap."""
        now_s = epoch.time_s
        if self.gap_start_s <= now_s < self.gap_end_s:
            return None
        if self.lie_start_s <= now_s < self.lie_end_s:
            lie = self.lie_m * (epoch.satellite == self.liar)
            return replace(epoch, pseudorange_m=epoch.pseudorange_m + lie)
        return epoch

    def of_stars(self, stars: StarAttitude, frame_s: float) -> StarAttitude:
        """Return what the star sensor gives instead.

        Parameters
        ----------
        stars : StarAttitude
        frame_s : float, s
            Between its frames.
        """
        late_s = stars.time_s - self.swapped_s
        if not -0.5 * frame_s <= late_s < (self.swapped_frames - 0.5) * frame_s:
            return stars
        turn = from_rotation_vector(np.deg2rad(self.swapped_deg) * np.full(3, np.sqrt(1.0 / 3.0)))
        return replace(
            stars, q_inertial_from_body_wxyz=multiplied(stars.q_inertial_from_body_wxyz, turn)
        )
