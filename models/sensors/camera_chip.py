"""The parameters of the detector and the lens, as data; the chain is in ``renders.detector``.

Sources: Teledyne e2v CCD42-40 data sheet for the chip of Opromolla 2022 (full well, read noise,
13.5 um pixels); quantum efficiency read off its deep-depletion curve near 825 nm. The f-number is
ours: at f/16 everything from 1.8 m to beyond 6.7 m is sharp to within a pixel (hyperfocal 4.1 m),
so defocus is an option (``Optics.focus_m``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import AnyArray, Floats

PLANCK_J_S = 6.62607015e-34
LIGHT_SPEED_M_S = 299_792_458.0


@dataclass(frozen=True)
class Optics:
    """What stands between the scene and the chip.

    Attributes
    ----------
    f_number : float
    transmission : float
        Of lens and filter within the passband.
    psf_sigma_px : float, px
        Gaussian point-spread function, 1 sigma on the native 13.5 um pixel. Diffraction alone
        is an Airy disc with its first zero at 1.22 lambda N, 16.1 um or 1.2 px at f/16 and 825 nm;
        the Gaussian nearest to it has 0.42 lambda N (Zhang et al. 2007, Applied Optics 46), 0.41
        px. The default adds 0.28 px of aberrations to that, in squares.
    vignetting : bool
        Whether illumination falls with the fourth power of the cosine off axis.
    focus_m : float, m
        Depth that is sharp, and all else as far as it lies from it (see
        ``renders.detector.defocus``); 0 is sharp at any depth.
    veiling_glare : float
        Share of the scene's light that the lens scatters widely; see
        ``renders.detector.veiling_glare``.
    veiling_glare_px : float, px
        How wide.
    """

    f_number: float = 16.0
    transmission: float = 0.8
    psf_sigma_px: float = 0.5
    vignetting: bool = True
    focus_m: float = 0.0
    veiling_glare: float = 0.0
    veiling_glare_px: float = 400.0


@dataclass(frozen=True)
class Detector:
    """A CCD or CMOS chip and its electronics.

    Attributes
    ----------
    pixel_pitch_um : float, um
    quantum_efficiency : float
        In the camera's band.
    prnu : float
        Pixel response non-uniformity, 1 sigma, relative; fixed for a chip.
    dark_current_e_s : float, e/s
    full_well_e : float, e
    blooming : float
        Share of the charge above the full well that spills to the pixels above and below.
    read_noise_e : float, e
    gain_e_dn : float, e/DN
    bias_dn : float, DN
    bits : int
    mosaic : str
        ``rggb`` behind Bayer's filters (``models.sensors.bayer_mosaic``), else ``none``.
    """

    pixel_pitch_um: float = 13.5
    quantum_efficiency: float = 0.5
    prnu: float = 0.005
    dark_current_e_s: float = 20.0
    full_well_e: float = 100_000.0
    blooming: float = 0.0
    read_noise_e: float = 12.0
    gain_e_dn: float = 26.0
    bias_dn: float = 100.0
    bits: int = 12
    mosaic: str = "none"

    @property
    def max_dn(self) -> int:
        """Largest number the converter gives."""
        return int(2**self.bits - 1)

    @property
    def saturation_dn(self) -> float:
        """Level of a full well, or of the converter's end if that comes first, DN."""
        return min(self.full_well_e / self.gain_e_dn + self.bias_dn, float(self.max_dn))

    def noise_dn(self, level_dn: AnyArray) -> Floats:
        """Return the 1-sigma temporal noise in DN of pixels at ``level_dn`` (bias included).

        Poisson of the collected charge, read noise and quantisation (Janesick 2007, chapter 5).
        """
        electrons = np.maximum((np.asarray(level_dn, float) - self.bias_dn) * self.gain_e_dn, 0.0)
        variance_e2 = electrons + self.read_noise_e**2
        return np.sqrt(variance_e2 / self.gain_e_dn**2 + 1.0 / 12.0)


@dataclass(frozen=True)
class Radiation:
    """Energetic particles that hit the chip; see ``renders.detector.radiation_hits``.

    Attributes
    ----------
    flux_cm2_s : float, 1/cm2/s
        How many cross each square centimetre of the chip; 0 is none.
    depth_um : float, um
        Thickness of the silicon whose charge is collected.
    charge_e_um : float, e/um
        What a particle leaves along its way.
    """

    flux_cm2_s: float = 0.0
    depth_um: float = 40.0
    charge_e_um: float = 106.0


def photon_energy_j(wavelength_nm: float) -> float:
    """Energy of one photon, J."""
    return PLANCK_J_S * LIGHT_SPEED_M_S / (wavelength_nm * 1e-9)
