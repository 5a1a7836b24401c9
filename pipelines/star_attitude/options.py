"""Settings of the star sensor."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class StarAttitudeOptions:
    """Settings.

    Attributes
    ----------
    detection_snr : float
        Of a spot over the noise, seen through the filter that matches it.
    sharpest : float
        Share of a spot's light that its central pixel may have: a hot pixel has all of it. (A star
        in the middle of a pixel has 0.28 at 0.7 px of spread, more by noise where it is faint.)
    most_spots : int
        The brightest are kept.
    most_misfit : float
        Chi-square over its degrees of freedom of a spot that is fitted as a star's: particles, hot
        pixels and close pairs are beyond.
    most_saturated : float
        Share of the chip above which a frame is refused.
    pattern_mag : float
        Faintest stars of the triangles.
    pattern_spots : int
        So many of the brightest spots make triangles.
    widest_deg, narrowest_deg : float, deg
        Sides of triangles.
    side_arcsec : float, arcsec
        By how much a side may differ from the catalogue's; aberration and calibration included.
    magnitude_tolerance : float
        By how much a spot's brightness may.
    crowded_px : float, px
        A star with a neighbour nearer than that is not asked for the attitude.
    crowded_mag : float
        By how much fainter such a neighbour may be.
    match_arcsec : tuple of float, arcsec
        Within which spots are matched to stars, round after round, ever better aligned.
    most_triangles : int
        Tried before a frame is refused.
    most_chance : float
        Of so many spots matching by chance, all that was tried considered, above which a frame is
        refused.
    floor_arcsec : float, arcsec
        Error of a star's place that no noise explains: catalogue and calibration.
    outlier_sigmas : float
        A matched star that is further from its place is not asked for the attitude.
    """

    detection_snr: float = 6.0
    sharpest: float = 0.45
    most_spots: int = 150
    most_misfit: float = 2.0
    most_saturated: float = 0.25
    pattern_mag: float = 5.4
    pattern_spots: int = 36
    widest_deg: float = 20.0
    narrowest_deg: float = 1.5
    side_arcsec: float = 25.0
    magnitude_tolerance: float = 0.8
    crowded_px: float = 5.0
    crowded_mag: float = 4.0
    match_arcsec: tuple[float, ...] = (150.0, 60.0, 30.0)
    most_triangles: int = 4000
    most_chance: float = 1e-7
    floor_arcsec: float = 0.1
    outlier_sigmas: float = 4.5
