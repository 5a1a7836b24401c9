"""Samples where the noise is: as many in each pixel as bring it below a share of the detector's.

Two stages, so that no mean is biased: a few samples in every pixel tell how noisy it is and are
then put aside; others, as many as that asks for, make the image. Each group's image is made of its
own number of samples, whatever other groups are traced with it, and a pixel's are added up in one
order: equal seeds give equal bits in any company.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import drjit as dr
import mitsuba as mi
import numpy as np
from scipy.ndimage import uniform_filter

from models.arrays import AnyArray, Floats, Radiance
from renders.tracing.group_integrator import Walk
from renders.tracing.noise_limit import Moments, NoiseLimit

PILOT = 4
CHUNK = 4  # samples of a lane
LANES = 1 << 24  # of a launch, times groups
PILOT_SEED = 0x9E3779B9  # beside the image's own


def trace_to_noise(
    walk: Walk,
    pixels: AnyArray,
    shape: tuple[int, int],
    limits: Mapping[str, NoiseLimit],
    seed: int,
) -> dict[str, Radiance]:
    """Trace pixels until their noise is below a limit.

    Parameters
    ----------
    walk : Walk
    pixels : (n,) uint32 array
        Indices ``row * width + column``.
    shape : (int, int), px
        Height and width of the image.
    limits : mapping of NoiseLimit
        By the name of a group.
    seed : int

    Returns
    -------
    dict of (n,) float32 arrays, W m-2 sr-1, by group name.
    """
    wanted = {
        group.name: limits[group.name].wanted(moments)
        for group, moments in zip(walk.groups, _pilot(walk, pixels, shape, seed), strict=True)
    }
    most = np.max(list(wanted.values()), axis=0)
    at_once = LANES // len(wanted)
    found = {name: np.zeros(len(pixels), dtype=np.float32) for name in wanted}
    for number in np.unique(most):
        lanes = int(number) // CHUNK
        chosen = np.flatnonzero(most == number)
        for part in np.split(chosen, range(at_once // lanes, len(chosen), at_once // lanes)):
            own = [each[part] for each in wanted.values()]
            for (name, image), sums in zip(
                found.items(), _walked(walk, pixels[part], lanes, own, seed), strict=True
            ):
                image[part] = sums / wanted[name][part]
    return found


def _pilot(walk: Walk, pixels: AnyArray, shape: tuple[int, int], seed: int) -> list[Moments]:
    """Trace a few samples of each pixel; return what they tell, group by group."""
    first = dr.zeros(mi.UInt32, len(pixels))
    of = mi.UInt32(np.asarray(pixels, dtype=np.uint32))
    found = walk(of, first, first + PILOT, seed ^ PILOT_SEED, moments=True)
    dr.eval(*found)
    every = []
    for sums in zip(*found, strict=True):
        mean, straight, straight_squared, bounced_squared = (
            _around(np.array(each, dtype=np.float64) / PILOT, pixels, shape) for each in sums
        )
        variance = straight_squared - straight * straight
        bounced = bounced_squared - (mean - straight) ** 2
        deviations = (np.sqrt(np.maximum(each, 0.0)) for each in (variance, bounced))
        every.append(Moments(mean, *deviations))
    return every


def _around(values: Floats, pixels: AnyArray, shape: tuple[int, int]) -> Floats:
    """Return the mean of each pixel and of those traced around it, half and half."""
    image, traced = np.zeros(shape), np.zeros(shape)
    image.ravel()[pixels], traced.ravel()[pixels] = values, 1.0
    total, count = uniform_filter(image, 3), uniform_filter(traced, 3)
    around = (total / np.maximum(count, 1e-9)).ravel()[pixels]
    return np.asarray(0.5 * around + 0.5 * values)


def _walked(
    walk: Walk, pixels: AnyArray, lanes: int, wanted: Sequence[AnyArray], seed: int
) -> list[Radiance]:
    """Return each group's sums over all lanes of a pixel, (n,), in their order."""
    lane = dr.arange(mi.UInt32, len(pixels) * lanes)
    own = lane // dr.opaque(mi.UInt32, lanes)
    first = lane % dr.opaque(mi.UInt32, lanes) * CHUNK

    def of(column: AnyArray) -> mi.UInt32:
        return dr.gather(mi.UInt32, mi.UInt32(np.ascontiguousarray(column, dtype=np.uint32)), own)

    sums, *_ = walk(of(pixels), first, first + CHUNK, seed, [of(each) for each in wanted])
    dr.eval(sums)
    totals = []
    for each in sums:
        parts = np.array(each).reshape(len(pixels), lanes)
        total = parts[:, 0].copy()
        for part in parts.T[1:]:
            total += part
        totals.append(total)
    return totals
