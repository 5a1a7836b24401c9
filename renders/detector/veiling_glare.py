"""Veiling glare: what the lens scatters over the whole image, from the scene and from the Sun.

Light of the scene: a share of every point's light is spread widely over the chip. ISO 9358 measures
it as the light in a black patch amid an even field; the glare spread function is taken as

    G(r) = r0 / (2 pi (r0^2 + r^2)^(3/2))

(a two-dimensional Cauchy distribution), which falls as r^-3 far out and whose Fourier transform is
``exp(-r0 k)``; the black patch of radius ``a`` then has ``share r0 / sqrt(r0^2 + a^2)``.

Light of the Sun, in the field or beside it: see ``models.sensors.lens_scatter``. The Sun's own
image is not made here; a Sun hidden by the target makes no glare, and that is the caller's to know.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.fft import dctn, idctn

from models.arrays import AnyArray, Floats, Radiance
from models.camera import Camera
from models.sensors.lens_scatter import LensScatter


def veiled(image: AnyArray, share: float, radius_px: float) -> Floats:
    """Spread a share of an image's light widely over it.

    The image goes on beyond its border as in a mirror: no light is gained or lost, and an even
    field stays even. A cosine transform does that.

    Parameters
    ----------
    image : (height, width) array
    share : float
        Of the light that is spread.
    radius_px : float, px
        Radius ``r0`` of the spread; it holds 29 % of the spread light, ten of them 90 %.

    Returns
    -------
    (height, width) array
        In the unit of the image.
    """
    sharp = np.asarray(image, dtype=np.float64)
    height, width = sharp.shape
    down, across = np.pi * np.arange(height) / height, np.pi * np.arange(width) / width
    kept = np.exp(-radius_px * np.hypot(down[:, None], across[None, :]))
    spread = np.maximum(idctn(dctn(sharp, type=2) * kept, type=2), 0.0)
    return (1.0 - share) * sharp + share * spread


def sun_glare(
    camera: Camera,
    sun_dir_in_cam: ArrayLike,
    irradiance_w_m2: float,
    scatter: LensScatter,
    sun_is_hidden: bool,
) -> Radiance | None:
    """Return the radiance that sunlight scattered in the lens is worth, W m-2 sr-1.

    Parameters
    ----------
    camera : Camera
        Its distortion is left out: glare varies slowly.
    sun_dir_in_cam : (3,) array
        Unit vector towards the Sun.
    irradiance_w_m2 : float, W/m2
        In the camera's band, on a surface that faces the Sun.
    scatter : LensScatter
    sun_is_hidden : bool
        Whether something stands between the lens and the Sun.

    Returns
    -------
    (height, width) float32 array, or None if there is no glare.
    """
    x, y, z = np.asarray(sun_dir_in_cam, dtype=np.float64)
    off_axis_deg = float(np.rad2deg(np.arccos(np.clip(z, -1.0, 1.0))))
    on_lens = irradiance_w_m2 * max(z, 0.0) * scatter.hood(off_axis_deg)
    if sun_is_hidden or scatter.peak_1_sr * on_lens <= 0.0:
        return None
    across = (np.arange(camera.width) - camera.cx) / camera.fx
    down = (np.arange(camera.height)[:, None] - camera.cy) / camera.fy
    cosine = (x * across + y * down + z) / np.sqrt(1.0 + across**2 + down**2)
    return np.asarray(on_lens * scatter.scattered(cosine), dtype=np.float32)
