"""What the filter says of its sensors and of itself: validity, diagnostics, protection levels.

Figure 1 of VINAG 2018 has these as outputs. A satellite is said to lie when most of its last epochs
were edited; an orbit or an attitude is in doubt when most of what speaks of it was, for a while.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from models.arrays import Floats, Indices, Mask

LIAR_EPOCHS = 5  # edited of late, by the count below, before a satellite is named
FORGET = 0.8  # of that count, an epoch
PROTECTION_SIGMAS = 5.33  # of a Gaussian error, exceeded once in ten million


@dataclass(eq=False)
class GnssVerdict:
    """What became of one epoch.

    Attributes
    ----------
    time_s : float, s
    satellite : (m,) int array
        Above the mask.
    tracked : int
        By the receiver.
    edited : (runs, m) bool array or None
        Left out; None where nothing is edited.
    nis : (runs,) array or None
    """

    time_s: float
    satellite: Indices
    tracked: int
    edited: Mask | None = None
    nis: Floats | None = None


@dataclass(eq=False)
class StarVerdict:
    """What became of one star attitude.

    Attributes
    ----------
    time_s : float, s
    refused : (runs,) bool array or None
    nis : (runs,) array or None
    """

    time_s: float
    refused: Mask | None = None
    nis: Floats | None = None


@dataclass(eq=False)
class Integrity:
    """Diagnostics of as many runs as there are.

    Attributes
    ----------
    runs : int
    late : int
        Records that came after their time.
    gnss, stars : last verdicts, or None before the first
    edited_ranges, refused_stars, doubts : (runs,) int array
        Counts since the start.
    """

    runs: int
    late: int = 0
    gnss: GnssVerdict | None = None
    stars: StarVerdict | None = None
    edited_ranges: Indices = field(init=False)
    refused_stars: Indices = field(init=False)
    doubts: Indices = field(init=False)
    _of_late: dict[int, Floats] = field(default_factory=dict)
    _odd_epochs: Indices = field(init=False)
    _odd_frames: Indices = field(init=False)

    def __post_init__(self) -> None:
        for name in ("edited_ranges", "refused_stars", "doubts", "_odd_epochs", "_odd_frames"):
            setattr(self, name, np.zeros(self.runs, dtype=np.int64))

    def note_gnss(self, verdict: GnssVerdict) -> None:
        """Count what was edited, satellite by satellite."""
        self.gnss = verdict
        if verdict.edited is None:
            return
        self.edited_ranges += verdict.edited.sum(axis=1)
        for place, satellite in enumerate(verdict.satellite.tolist()):
            before = self._of_late.get(satellite, np.zeros(self.runs))
            self._of_late[satellite] = FORGET * before + verdict.edited[:, place]

    def note_stars(self, verdict: StarVerdict) -> None:
        """Count what was refused."""
        self.stars = verdict
        if verdict.refused is not None:
            self.refused_stars += verdict.refused

    def liars(self, run: int = 0) -> list[int]:
        """Return the satellites of which the last epochs were edited."""
        limit = (1.0 - FORGET**LIAR_EPOCHS) / (1.0 - FORGET) - 1e-9
        return sorted(each for each, late in self._of_late.items() if late[run] >= limit)

    def orbits_in_doubt(self, verdict: GnssVerdict, patience: int) -> Mask:
        """Return whose orbit is in doubt, (runs,): most satellites were edited for so long.

        Parameters
        ----------
        verdict : GnssVerdict
        patience : int
            Epochs in a row.
        """
        if verdict.edited is None:
            return np.zeros(self.runs, dtype=np.bool_)
        odd = 2 * verdict.edited.sum(axis=1) > len(verdict.satellite)
        return self._in_doubt(self._odd_epochs, odd, patience)

    def attitudes_in_doubt(self, verdict: StarVerdict, patience: int) -> Mask:
        """Return whose attitude is in doubt, (runs,): all stars were refused for so long.

        Parameters
        ----------
        verdict : StarVerdict
        patience : int
            Frames in a row.
        """
        if verdict.refused is None:
            return np.zeros(self.runs, dtype=np.bool_)
        return self._in_doubt(self._odd_frames, verdict.refused, patience)

    def _in_doubt(self, count: Indices, odd: Mask, patience: int) -> Mask:
        count[:] = np.where(odd, count + 1, 0)
        doubted = count >= patience
        count[doubted] = 0
        self.doubts += doubted
        return doubted


def protection_levels_m(covariance: Floats, axes: Floats) -> Floats:
    """Return what the position error along some axes stays below but once in ten million, (..., 3).

    Parameters
    ----------
    covariance : (..., 3, 3) array, m2
        Of the position.
    axes : (..., 3, 3) array
        Unit vectors as columns.
    """
    along = np.einsum("...ji,...jk,...ki->...i", axes, covariance, axes)
    return PROTECTION_SIGMAS * np.sqrt(along)
