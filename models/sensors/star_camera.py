"""A star sensor as a camera: lens, chip, baffle, and how it is mounted.

A sensor of the small class: 20 deg of sky on a megapixel, no filter, spots spread over a few pixels
so that their middles can be told (Liebe 2002, Accuracy performance of star trackers: a tutorial,
IEEE Transactions on Aerospace and Electronic Systems 38). All numbers are ours, and no product's.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from models.arrays import Floats
from models.camera import Camera
from models.sensors.camera_chip import Detector, Optics, Radiation
from models.sensors.lens_scatter import LensScatter
from models.sky.broadband_flux import zero_magnitude_photons_m2_s

FIELD_DEG = 20.0


@dataclass(frozen=True)
class StarCamera:
    """A star camera.

    Attributes
    ----------
    camera : Camera
        As calibrated.
    optics : Optics
    detector : Detector
    band_nm : (float, float), nm
        Within which lens and chip have the transmission and the quantum efficiency told.
    exposure_ms : float, ms
        The attitude is that of its middle.
    rate_hz : float, Hz
    scatter : LensScatter
        Of the lens, for the Sun, Moon and Earth; its hood is the baffle, for the Sun and Earth.
    radiation : Radiation
    hot_share : float
        Of the pixels, whose dark current is far beyond the others'.
    hot_e_s : float, e/s
        Their median dark current; it is lognormal, a factor of e for 1 sigma.
    sky_mag_arcsec2 : float
        Brightness of the sky between the stars: zodiacal light and stars too faint to tell.
    boresight_in_body : (float, float, float)
        Unit vector.
    """

    camera: Camera = field(default_factory=lambda: Camera.from_fov(1024, 1024, FIELD_DEG))
    optics: Optics = field(
        default_factory=lambda: Optics(
            f_number=2.0, transmission=0.8, psf_sigma_px=0.7, vignetting=False
        )
    )
    detector: Detector = field(
        default_factory=lambda: Detector(
            pixel_pitch_um=8.0,
            quantum_efficiency=0.5,
            prnu=0.01,
            dark_current_e_s=10.0,
            full_well_e=60_000.0,
            read_noise_e=20.0,
            gain_e_dn=4.0,
            bits=14,
        )
    )
    band_nm: tuple[float, float] = (400.0, 900.0)
    exposure_ms: float = 100.0
    rate_hz: float = 5.0
    scatter: LensScatter = field(
        default_factory=lambda: LensScatter(peak_1_sr=3.0, hood_deg=30.0, hood_leak=1e-4)
    )
    radiation: Radiation = field(default_factory=lambda: Radiation(flux_cm2_s=5.0, depth_um=10.0))
    hot_share: float = 1e-4
    hot_e_s: float = 5000.0
    sky_mag_arcsec2: float = 21.5
    boresight_in_body: tuple[float, float, float] = (0.0, -1.0, 0.0)

    @property
    def exposure_s(self) -> float:
        """Exposure time, s."""
        return 1e-3 * self.exposure_ms

    @cached_property
    def zero_magnitude_e_s(self) -> float:
        """Electrons a second of a star of magnitude 0 on axis."""
        focal_m = self.camera.fx * self.detector.pixel_pitch_um * 1e-6
        pupil_m2 = 0.25 * np.pi * (focal_m / self.optics.f_number) ** 2
        passed = self.optics.transmission * self.detector.quantum_efficiency
        return float(pupil_m2 * passed * zero_magnitude_photons_m2_s(*self.band_nm))

    @cached_property
    def body_from_cam(self) -> Floats:
        """(3, 3) array: the camera looks along the boresight; its x lies across the body's z."""
        forward = np.array(self.boresight_in_body)
        aside = np.eye(3)[int(np.argmin(np.abs(forward)))]
        right = np.cross(aside, forward)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(forward, right), forward], axis=1)

    def electrons(self, magnitude: Floats) -> Floats:
        """Return the charge that stars leave in an exposure, e, by their magnitudes, (...,)."""
        return self.zero_magnitude_e_s * self.exposure_s * 10.0 ** (-0.4 * magnitude)


def star_camera(pixels: int = 1024) -> StarCamera:
    """Return the star camera with so many pixels a side: as wide a field, as wide a lens.

    Parameters
    ----------
    pixels : int
    """
    own = StarCamera()
    pitch_um = own.detector.pixel_pitch_um * own.camera.width / pixels
    return replace(
        own,
        camera=Camera.from_fov(pixels, pixels, FIELD_DEG),
        detector=replace(own.detector, pixel_pitch_um=pitch_um),
    )
