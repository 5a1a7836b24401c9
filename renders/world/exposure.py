"""One exposure to be taken, and how its files are named."""

from __future__ import annotations

from dataclasses import dataclass

FILTERED = 0  # the band of a single image: all that the camera's filter passes, and no lamps


@dataclass(frozen=True)
class Exposure:
    """One image to be taken: frame number, band and middle of the exposure, s.

    The band is 800 or 850, or ``FILTERED`` for a single image; it keys the random numbers.
    """

    frame: int
    band: int
    time_s: float

    @property
    def name(self) -> str:
        """How its files are named."""
        return exposure_name(self.frame, self.band)


def exposure_name(index: int, band: int) -> str:
    """Return how the files of one exposure are named; ``band`` is 800, 850 or ``FILTERED``."""
    return f"{index:06d}{band_suffix(band)}"


def band_suffix(band: int) -> str:
    """Return what a band adds to a file's name."""
    return "" if band == FILTERED else f"_{band}"
