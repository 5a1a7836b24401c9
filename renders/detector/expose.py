"""From radiance to a detector frame: the chain of a real camera, in its order, without Mitsuba.

Optics (defocus, point spread, vignetting, glare) -> photons -> quantum efficiency and pixel
response -> dark current -> Poisson -> particles -> full well, blooming -> read noise -> gain, bias
-> converter. Nothing is added that lens and chip do not name, and equal seeds give equal bits.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from models.arrays import Floats, Image, Radiance
from models.camera import Camera
from models.errors import ScenarioError
from models.sensors.camera_chip import Detector, Optics, photon_energy_j
from renders.detector.blooming import bloom
from renders.detector.defocus import circle_of_confusion_px, defocused
from renders.detector.drift import Drift, Part
from renders.detector.point_spread import blur
from renders.detector.veiling_glare import veiled
from renders.tracing.light_groups import LampGroup, LightGroup

SUNLIGHT_NM = 825.0  # middle of the 790 to 860 nm passband, for sunlight's mean photon
MOST_ELECTRONS = 1e15  # far beyond any full well, and within what Poisson numbers are drawn of
CHIP_SEED = 20220  # one chip flies: its pixel response is the same in every frame and run


def electrons_per_radiance(optics: Optics, detector: Detector, wavelength_nm: float) -> float:
    """Return electrons per pixel and second for 1 W m-2 sr-1 on axis.

    The camera equation: irradiance on the chip is ``L tau pi / (4 N^2)`` (focused far off), times
    pixel area, over the photon's energy, times quantum efficiency.

    Parameters
    ----------
    optics : Optics
    detector : Detector
    wavelength_nm : float, nm
        Of the light; it sets a photon's energy.
    """
    irradiance = optics.transmission * np.pi / (4.0 * optics.f_number**2)
    area_m2 = (detector.pixel_pitch_um * 1e-6) ** 2
    return float(
        irradiance * area_m2 * detector.quantum_efficiency / photon_energy_j(wavelength_nm)
    )


@lru_cache(maxsize=4)
def vignetting(camera: Camera) -> Floats:
    """Return the fourth power of the cosine off axis at each pixel, (height, width)."""
    v, u = np.mgrid[0 : camera.height, 0 : camera.width].astype(np.float64)
    x = (u - camera.cx) / camera.fx
    y = (v - camera.cy) / camera.fy
    return 1.0 / (1.0 + x**2 + y**2) ** 2


@lru_cache(maxsize=4)
def pixel_response(height: int, width: int, sigma: float) -> Radiance:
    """Return the chip's fixed pattern of relative response.

    Parameters
    ----------
    height, width : int, px
    sigma : float
        1 sigma of the pattern, about 1.

    Returns
    -------
    (height, width) float32 array
    """
    rng = np.random.default_rng(CHIP_SEED)
    pattern = 1.0 + sigma * rng.standard_normal((height, width), dtype=np.float32)
    return np.maximum(pattern, 0.0)


def electron_rate(
    groups: Mapping[LightGroup, Radiance],
    optics: Optics,
    detector: Detector,
    scales: Mapping[str, float] | None = None,
) -> Radiance:
    """Add light groups up to electrons per pixel and second, on axis and unblurred.

    Parameters
    ----------
    groups : mapping of LightGroup to (height, width) arrays, W m-2 sr-1
    optics : Optics
    detector : Detector
    scales : mapping of str to float, optional
        Factor by group name, such as another lamp power; 1 where not named.

    Returns
    -------
    (height, width) float32 array, e/s

    Raises
    ------
    ValueError
        If there is no light group.
    """
    total: Radiance | None = None
    for group, radiance in groups.items():
        wavelength = group.ring.wavelength_nm if isinstance(group, LampGroup) else SUNLIGHT_NM
        factor = electrons_per_radiance(optics, detector, wavelength)
        factor *= (scales or {}).get(group.name, 1.0)
        share = radiance * np.float32(factor)
        total = share if total is None else total + share
    if total is None:
        raise ValueError("expected at least one light group, got none")
    return total


def mean_electrons(
    rate_e_s: Radiance,
    exposure_ms: float,
    camera: Camera,
    optics: Optics,
    detector: Detector,
    depth_m: Radiance | None = None,
    drift: Drift | None = None,
    part: Part | None = None,
) -> Floats:
    """Return the expected charge of each pixel before the full well.

    Parameters
    ----------
    rate_e_s : (height, width) array, e/s
        As ``electron_rate`` gives it.
    exposure_ms : float, ms
    camera : Camera
    optics : Optics
    detector : Detector
    depth_m : (height, width) array, m, optional
        What a lens with a focus needs beside the light.
    drift : Drift, optional
        What the lens has become.
    part : (slice, slice), optional
        Rows and columns that ``rate_e_s`` is of; the whole image unless given.

    Returns
    -------
    (height, width) array, e

    Raises
    ------
    ScenarioError
        If it needs depth and there is none.
    """
    here = part or (slice(0, camera.height), slice(0, camera.width))
    if optics.focus_m > 0.0:
        if depth_m is None:
            raise ScenarioError(
                f"expected the depth of each pixel, which a lens focused at {optics.focus_m:g} m "
                "needs, got light alone; set optics.focus_m to 0, sharp at any depth"
            )
        circle_px = circle_of_confusion_px(depth_m, optics, camera, detector)
        rate_e_s = defocused(rate_e_s, circle_px).astype(np.float32)
    if drift is None:
        charge = blur(rate_e_s, optics.psf_sigma_px)
    else:
        charge = drift.blurred(rate_e_s, optics.psf_sigma_px, camera, here)
        charge *= drift.darkened(camera, here)
    if optics.vignetting:
        charge *= vignetting(camera)[here]
    if optics.veiling_glare > 0.0:
        charge = veiled(charge, optics.veiling_glare, optics.veiling_glare_px)
    if detector.prnu > 0.0:
        charge *= pixel_response(camera.height, camera.width, detector.prnu)[here]
    return (charge + detector.dark_current_e_s) * (exposure_ms * 1e-3)


def expose_electrons(
    mean_e: Floats,
    detector: Detector,
    rng: np.random.Generator,
    deposited_e: Floats | None = None,
) -> Image:
    """Draw one frame from the expected charge.

    Parameters
    ----------
    mean_e : (height, width) array, e
    detector : Detector
    rng : numpy Generator
    deposited_e : (height, width) array, e, optional
        Charge that particles left; see ``renders.detector.radiation_hits``.

    Returns
    -------
    (height, width) uint16 array, DN.
    """
    charge = rng.poisson(np.minimum(mean_e, MOST_ELECTRONS)).astype(np.float64)
    if deposited_e is not None:
        charge += deposited_e
    charge = bloom(charge, detector.full_well_e, detector.blooming)
    charge += detector.read_noise_e * rng.standard_normal(charge.shape, dtype=np.float32)
    level = np.rint(charge / detector.gain_e_dn + detector.bias_dn)
    return np.clip(level, 0, detector.max_dn).astype(np.uint16)


def exposure_rng(run: int, frame: int, band: int, *seeds: int) -> np.random.Generator:
    """Return the random numbers of one exposure: keyed, never drawn in sequence.

    Parameters
    ----------
    run, frame, band : int
        The band is 800 or 850, or another number that tells the exposures of a frame apart.
    *seeds : int
        That of a case whose noise is its own.
    """
    return np.random.default_rng(np.random.SeedSequence([run, frame, band, *seeds]))
