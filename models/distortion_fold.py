"""Where a Brown-Conrady distortion stops being one-to-one: beyond its fold far points come back.

The distortion is the gradient of a potential, its Jacobian symmetric: on a disc in which the
Jacobian is positive definite the potential is strictly convex, and no two points meet.
"""

from __future__ import annotations

import numpy as np

REAL = 1e-9  # imaginary part, over the size, below which a computed root counts as real


def fold_radius(k1: float, k2: float, p1: float, p2: float, k3: float) -> float:
    """Return the radius, in undistorted normalised coordinates, within which nothing folds.

    With ``b = 1 + k1 r^2 + k2 r^4 + k3 r^6``, ``a = d(r b) / dr`` and ``P = |(p2, p1)|``, the
    Jacobian's form along a unit vector with the share t of its square along the radius is, in the
    worst direction, ``a t + b (1 - t) - 2 r P sqrt(1 + 8 t)``. The root lies below its tangent at
    t = 1, so the form is at least the lesser of ``a - 6 r P``, which a barrel reaches, and
    ``b - 10/3 r P``. The first radius at which either vanishes is returned; infinity if none does.

    Parameters
    ----------
    k1, k2, p1, p2, k3 : float
        As ``models.camera.Camera`` has them.
    """
    tangential = float(np.hypot(p1, p2))
    along = [1.0, -6.0 * tangential, 3.0 * k1, 0.0, 5.0 * k2, 0.0, 7.0 * k3]
    across = [1.0, -10.0 / 3.0 * tangential, k1, 0.0, k2, 0.0, k3]
    return min(_first_root(along), _first_root(across))


def _first_root(rising: list[float]) -> float:
    """Return the least positive root of ``c0 + c1 r + c2 r^2 + ...`` with c0 = 1, or infinity."""
    inverse = np.asarray(
        np.roots(rising), dtype=np.complex128
    )  # of the polynomial in 1 / r, which is monic
    real = inverse.real[np.abs(inverse.imag) <= REAL * np.abs(inverse)]
    largest = float(real.max(initial=0.0))
    return 1.0 / largest if largest > 0.0 else np.inf
