"""What is wrong with a covariance offered to a filter: one bad number stays in a state for ever."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats

SYMMETRIC = 1e-9  # of two entries' geometric mean variance: products round at 1e-15
SIGMAS = (1e-12, 1e6)  # rad and m: no camera measures better, and what is worse tells nothing


def positive(covariance: Floats) -> bool:
    """Tell whether a symmetric (n, n) matrix is finite and positive definite."""
    diagonal = np.diagonal(covariance)
    if not (np.isfinite(covariance).all() and (diagonal > 0.0).all()):
        return False
    scale = np.sqrt(diagonal)
    try:
        np.linalg.cholesky(covariance / np.outer(scale, scale))
    except np.linalg.LinAlgError:
        return False
    return True


def covariance_fault(covariance: Floats | None) -> str:
    """Return why a pose with this covariance cannot be taken in, in words; empty where it can.

    Parameters
    ----------
    covariance : (6, 6) array or None, rad and m
    """
    if covariance is None or np.shape(covariance) != (6, 6):
        return "no (6, 6) covariance"
    if not np.isfinite(covariance).all():
        return "a covariance that is not finite"
    variance = np.diagonal(covariance)
    if not (variance > 0.0).all():
        return "a covariance that is not positive"
    sigma = np.sqrt(variance)
    if not ((sigma >= SIGMAS[0]) & (sigma <= SIGMAS[1])).all():
        return f"sigmas of {sigma.min():.1g} to {sigma.max():.1g} rad and m, which no camera has"
    if (np.abs(covariance - covariance.T) > SYMMETRIC * np.outer(sigma, sigma)).any():
        return "a covariance that is not symmetric"
    return "" if positive(covariance) else "a covariance that is not positive"
