"""What ranges, rates and star attitudes should read, by a state, and how well."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Indices, Mask
from models.gnss.signal_path import lowest_height_m
from models.navigation_records import GnssEpoch
from pipelines.absolute.error_state import CLOCK_BIAS, CLOCK_DRIFT, POSITION, VELOCITY
from pipelines.absolute.options import AbsoluteOptions


def ranges_and_rates(vector: Floats, epoch: GnssEpoch, slots: Indices | None = None) -> Floats:
    """Return pseudoranges, then range rates, (..., 2 m), m and m/s.

    Parameters
    ----------
    vector : (..., n) array
    epoch : GnssEpoch
        Of m satellites.
    slots : (m,) int array or None
        Where in the vector each one's lasting error stands; None where errors do not last.
    """
    x, y, z = (vector[..., POSITION.start + k, None] - epoch.sent_from_m[:, k] for k in range(3))
    distance = np.sqrt(x * x + y * y + z * z)
    u, v, w = (vector[..., VELOCITY.start + k, None] - epoch.sent_at_m_s[:, k] for k in range(3))
    rate = (x * u + y * v + z * w) / distance
    if slots is not None:
        distance = distance + vector[..., slots]
    return np.concatenate(
        [distance + vector[..., CLOCK_BIAS, None], rate + vector[..., CLOCK_DRIFT, None]], axis=-1
    )


def range_and_rate_sigmas(epoch: GnssEpoch, options: AbsoluteOptions) -> Floats:
    """Return 1 sigma of each, (2 m,), m and m/s."""
    cn0 = epoch.cn0_dbhz
    if options.nominal_cn0_dbhz is not None:
        cn0 = np.full_like(cn0, options.nominal_cn0_dbhz)
    ranges = np.hypot(options.range_sigma_m, options.loops.code_sigma_m(cn0))
    return np.concatenate([ranges, options.loops.rate_sigma_m_s(cn0)])


def unmasked(epoch: GnssEpoch, position: Floats, options: AbsoluteOptions) -> Mask:
    """Return which signals pass above the mask's height, (m,).

    Parameters
    ----------
    epoch : GnssEpoch
        Of m satellites.
    position : (3,) array, m
        Of the receiver, as estimated.
    options : AbsoluteOptions
    """
    if not np.isfinite(options.mask_height_m):
        return np.ones(len(epoch.satellite), dtype=np.bool_)
    return lowest_height_m(position[None, :], epoch.sent_from_m) > options.mask_height_m
