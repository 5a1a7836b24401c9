"""The first pose a pipeline is given: the truth plus what navigation did not know."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from models.pose import RigidTransform, euler_321_from_rotation, rotation_from_euler_321

# Opromolla et al. 2022, Table 5, 1 sigma: translation in m, (alpha, beta, gamma) in deg.
CHASER_FIXED_SIGMA_M = (0.017, 0.017, 0.05)
CHASER_FIXED_SIGMA_DEG = (1.0, 1.0, 1.0)
EYE_IN_HAND_SIGMA_M = (0.010, 0.010, 0.010)
EYE_IN_HAND_SIGMA_DEG = (0.667, 0.667, 0.667)


def draw_prior(
    cam_from_target: RigidTransform,
    sigma_m: ArrayLike,
    sigma_deg: ArrayLike,
    rng: np.random.Generator,
) -> RigidTransform:
    """Draw a pose about the true one, Gaussian and independent on all six parameters.

    Parameters
    ----------
    cam_from_target : RigidTransform
        The truth.
    sigma_m : (3,) array, m
        1 sigma of the translation, in the camera's axes.
    sigma_deg : (3,) array, deg
        1 sigma of the 3-2-1 angles (alpha, beta, gamma).
    rng : numpy.random.Generator
        Six numbers are taken from it, translation first.

    Raises
    ------
    ValueError
        If a sigma is negative, not finite, or there are not three.
    """
    for sigma in (np.asarray(sigma_m), np.asarray(sigma_deg)):
        if sigma.shape != (3,) or not (np.isfinite(sigma) & (sigma >= 0.0)).all():
            raise ValueError(
                "expected three sigmas in m and three in deg, none negative, "
                f"got {sigma_m!r} and {sigma_deg!r}"
            )
    noise = np.array([sigma_m, sigma_deg]) * rng.standard_normal((2, 3))
    return RigidTransform(
        rotation_from_euler_321(euler_321_from_rotation(cam_from_target.rotation) + noise[1]),
        cam_from_target.translation + noise[0],
    )
