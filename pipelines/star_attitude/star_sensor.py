"""The star sensor: an image in, an attitude with its covariance out, or why there is none."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Image, Indices
from models.sensors.star_camera import StarCamera
from models.sky.aberration import aberrated
from pipelines.star_attitude.onboard_catalogue import OnboardCatalogue, onboard_catalogue
from pipelines.star_attitude.options import StarAttitudeOptions
from pipelines.star_attitude.spot_detection import spot_image, spot_peaks
from pipelines.star_attitude.spot_fit import Spots, fit_spots
from pipelines.star_attitude.star_match import StarMatch, matched
from pipelines.star_attitude.triangle_search import ARCSEC, same_triangles, triangles
from pipelines.star_attitude.wahba import wahba_attitude, wahba_covariance

FEWEST_SPOTS = 4
FEWEST_CLEAN = 4  # stars without a neighbour, below which crowded ones are asked, too
MAGNITUDE_MARGIN = 0.5  # a spot that much fainter than any star of a triangle may still be one
ROUNDS = 3
NO_TURN = np.zeros(3)


@dataclass(frozen=True, eq=False)
class StarFix:
    """What a frame says.

    Attributes
    ----------
    cam_from_icrs : (3, 3) array or None
        In the middle of the exposure; None if refused.
    covariance_rad2 : (3, 3) array or None, rad2
        Of the rotation vector, in camera axes, that carries the truth to it.
    reason : str
        Why there is none, else empty.
    spots : Spots
    identified : (n, 2) int array
        Row of a spot, and number of the star in the Hipparcos catalogue, used or not.
    triangles : int
        That were tried.
    """

    cam_from_icrs: Floats | None
    covariance_rad2: Floats | None
    reason: str
    spots: Spots
    identified: Indices
    triangles: int = 0

    def __bool__(self) -> bool:
        return self.cam_from_icrs is not None


class StarSensor:
    """Finds attitudes in frames of one camera, each by itself: nothing is remembered.

    Parameters
    ----------
    sensor : StarCamera
        As calibrated.
    options : StarAttitudeOptions, optional
    """

    def __init__(self, sensor: StarCamera, options: StarAttitudeOptions | None = None) -> None:
        self.sensor = sensor
        self.options = options or StarAttitudeOptions()
        self.catalogue: OnboardCatalogue = onboard_catalogue(sensor.camera, self.options)

    def find(
        self, image: Image, rate_in_cam_rad_s: Floats = NO_TURN, velocity_m_s: Floats = NO_TURN
    ) -> StarFix:
        """Return which way the camera looked.

        Parameters
        ----------
        image : (height, width) uint16 array, DN
        rate_in_cam_rad_s : (3,) array, rad/s
            By the gyroscopes: it says how spots are drawn out.
        velocity_m_s : (3,) array, m/s
            Against the solar system's barycentre, ICRS: where stars seem to stand.
        """
        camera, options = self.sensor.camera, self.options
        if image.shape != (camera.height, camera.width):
            return _refused(
                f"expected an image of {camera.height} x {camera.width} px, got "
                f"{' x '.join(map(str, image.shape))}"
            )
        seen = spot_image(image, self.sensor)
        if seen.saturated_share > options.most_saturated:
            return _refused(
                f"{100 * seen.saturated_share:.0f} % of the image is saturated, at most "
                f"{100 * options.most_saturated:.0f} % may be"
            )
        middle = np.array([[camera.cx, camera.cy]])
        smear = self._smears(middle, rate_in_cam_rad_s)[0]
        peaks = spot_peaks(seen, self.sensor, smear, options)
        spots = fit_spots(
            seen, peaks, self._smears(peaks.astype(np.float64), rate_in_cam_rad_s), self.sensor,
            options,
        )  # fmt: skip
        if len(spots) < FEWEST_SPOTS:
            return _refused(
                f"{len(spots)} spots look like stars, at least {FEWEST_SPOTS} are needed", spots
            )
        return self._identified(spots, velocity_m_s)

    def _smears(self, pixels: Floats, rate_rad_s: Floats) -> Floats:
        """Return by how much stars at pixels (n, 2) move during the exposure, (n, 2), px."""
        camera = self.sensor.camera
        rays = camera.rays(pixels)
        half = 0.5 * self.sensor.exposure_s * np.cross(rate_rad_s, rays)
        return camera.project(rays - half) - camera.project(rays + half)

    def _identified(self, spots: Spots, velocity_m_s: Floats) -> StarFix:
        options, sensor = self.options, self.sensor
        seen = sensor.camera.rays(spots.pixels)
        magnitude = -2.5 * np.log10(spots.electrons / float(sensor.electrons(np.zeros(1))[0]))
        bright = np.flatnonzero(magnitude < options.pattern_mag + MAGNITUDE_MARGIN)
        bright = bright[: options.pattern_spots]
        tried, tested, best = 0, 0, 0
        for three in triangles(len(bright)):
            if tried >= options.most_triangles:
                break
            own = bright[list(three)]
            corners = (int(own[0]), int(own[1]), int(own[2]))
            found = same_triangles(seen, magnitude, corners, self.catalogue, options)
            if found is None:
                continue
            tried += 1
            for stars in found:
                tested += 1
                match = matched(seen, own, stars, velocity_m_s, self.catalogue, options)
                if match is None:
                    continue
                best = max(best, len(match.spots))
                if match.chance * tested < options.most_chance:
                    return self._fix(spots, seen, match, velocity_m_s, tried)
        return _refused(
            f"{tried} triangles of {len(bright)} bright spots agree with no part of the sky; at "
            f"best {best} of {len(spots)} spots match stars",
            spots,
            tried,
        )

    def _fix(
        self, spots: Spots, seen: Floats, match: StarMatch, velocity_m_s: Floats, tried: int
    ) -> StarFix:
        """Return the attitude by all stars that hold, weighted by how well each is seen."""
        options, camera = self.options, self.sensor.camera
        identified = np.stack([match.spots, self.catalogue.numbers[match.stars]], axis=1)
        clean = ~self.catalogue.crowded[match.stars]
        if np.count_nonzero(clean) < FEWEST_CLEAN:
            clean[:] = True
        own, stars = match.spots[clean], match.stars[clean]
        known = aberrated(self.catalogue.directions[stars], velocity_m_s)
        spread_px2 = 0.5 * np.trace(spots.covariance_px2[own], axis1=1, axis2=2)
        variances = spread_px2 * seen[own, 2] ** 3 / (camera.fx * camera.fy)
        variances = variances + (options.floor_arcsec * ARCSEC) ** 2
        kept = np.ones(len(own), dtype=np.bool_)
        for _ in range(ROUNDS):
            attitude = wahba_attitude(seen[own][kept], known[kept], 1.0 / variances[kept])
            off = np.sum((seen[own] - known @ attitude.T) ** 2, axis=1) / variances
            now = off < options.outlier_sigmas**2
            if np.count_nonzero(now) < FEWEST_CLEAN or (now == kept).all():
                break
            kept = now
        used = own[kept]
        freedom = max(2 * len(used) - 3, 1)
        misfit = float(off[kept].sum() / freedom)
        if misfit > options.outlier_sigmas**2:
            return _refused(
                f"the {len(used)} stars' places are {np.sqrt(misfit):.1f} sigmas off in the mean: "
                "check the calibration",
                spots,
                tried,
            )
        covariance = wahba_covariance(seen[used], variances[kept]) * max(misfit, 1.0)
        return StarFix(attitude, covariance, "", spots, identified, tried)


def _refused(reason: str, spots: Spots | None = None, tried: int = 0) -> StarFix:
    none = Spots(np.zeros((0, 2)), np.zeros((0, 2, 2)), np.zeros(0), np.zeros(0))
    return StarFix(None, None, reason, spots or none, np.zeros((0, 2), np.int64), tried)
