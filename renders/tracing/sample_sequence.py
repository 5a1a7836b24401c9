"""Where the samples of a pixel fall: Owen-scrambled Sobol points, two dimensions at a time.

Points of a (0, 2)-sequence are spread evenly in both dimensions, so that light that varies smoothly
over the Sun's disc or over a lobe is integrated with less noise than independent points leave. Each
pair of dimensions has its own scramble and its own order of the points, keyed by the lane's random
key and the pair's number, so that pairs are independent of one another and pixels of one another.

Source: Burley 2020, Practical hash-based Owen scrambling, JCGT 9(4); Laine and Karras 2011,
Stratified sampling for stochastic transparency.
"""

from __future__ import annotations

from typing import Any

import drjit as dr
import mitsuba as mi

TO_UNIT = 2.0**-24  # of the upper 24 bits, so that the largest is still below one


def mixed(key: Any, number: Any) -> Any:
    """Return a hash of two 32-bit numbers (Tiny Encryption Algorithm, as Mitsuba's samplers do)."""
    return mi.sample_tea_32(key, number)[0]


def owen_scrambled(bits: Any, key: Any) -> Any:
    """Return 32-bit fractions scrambled bit by bit, each by the bits above it (Burley 2020, 3)."""
    x = dr.brev(bits) + key
    x ^= x * 0x6C50B47C
    x ^= x * 0xB82F1E52
    x ^= x * 0xC7AFE638
    x ^= x * 0x8D22F6E6
    return dr.brev(x)


def sobol_second(index: Any) -> Any:
    """Return the second Sobol coordinate as a 32-bit fraction; the first is ``brev(index)``.

    Its generator matrix is Pascal's triangle modulo two, which factors into five butterflies.
    """
    x = mi.UInt32(index)
    x ^= (x >> 16) & 0x0000FFFF
    x ^= (x >> 8) & 0x00FF00FF
    x ^= (x >> 4) & 0x0F0F0F0F
    x ^= (x >> 2) & 0x33333333
    x ^= (x >> 1) & 0x55555555
    return dr.brev(x)


def points_2d(index: Any, key: Any, pair: Any) -> Any:
    """Return sample ``index`` of a lane's pair of dimensions, a point of the unit square.

    Parameters
    ----------
    index : UInt32
        Number of the sample within its pixel.
    key : UInt32
        The pixel's random key.
    pair : UInt32
        Number of the pair of dimensions.
    """
    first, second = mi.sample_tea_32(key, pair)
    order = owen_scrambled(mi.UInt32(index), first ^ second)
    x = owen_scrambled(dr.brev(order), first)
    y = owen_scrambled(sobol_second(order), second)
    return mi.Point2f(mi.Float(x >> 8) * TO_UNIT, mi.Float(y >> 8) * TO_UNIT)
