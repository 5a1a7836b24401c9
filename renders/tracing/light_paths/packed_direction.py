"""Directions in 32 bits.

The sphere is folded onto a square through an octahedron, so that packing costs a few additions and
no table (Cigolle et al. 2014, A survey of efficient representations for independent
unit vectors, JCGT 3(2)).
"""

from __future__ import annotations

from typing import Any

import drjit as dr
import mitsuba as mi

STEPS = 65535.0  # of each coordinate of a packed direction: 0.003 deg


def square_of(direction: Any) -> tuple[Any, Any]:
    """Return where a direction falls on the unit square, on Dr.Jit vectors.

    Parameters
    ----------
    direction : Vector3f
        Unit.
    """
    size = dr.abs(direction.x) + dr.abs(direction.y) + dr.abs(direction.z)
    x, y = direction.x / size, direction.y / size
    below = direction.z < 0.0
    folded_x = dr.mulsign(1.0 - dr.abs(y), x)
    folded_y = dr.mulsign(1.0 - dr.abs(x), y)
    x, y = dr.select(below, folded_x, x), dr.select(below, folded_y, y)
    return 0.5 * x + 0.5, 0.5 * y + 0.5


def packed(direction: Any) -> Any:
    """Return a direction, Vector3f, in the two halves of a UInt32."""
    u, v = square_of(direction)
    low, high = mi.UInt32(u * STEPS + 0.5), mi.UInt32(v * STEPS + 0.5)
    return dr.minimum(low, 65535) | (dr.minimum(high, 65535) << 16)


def unpacked(packed_direction: Any) -> Any:
    """Return a direction, Vector3f of unit length, from a UInt32."""
    u = mi.Float(packed_direction & 0xFFFF) * (2.0 / STEPS) - 1.0
    v = mi.Float(packed_direction >> 16) * (2.0 / STEPS) - 1.0
    z = 1.0 - dr.abs(u) - dr.abs(v)
    fold = dr.maximum(-z, 0.0)
    return dr.normalize(mi.Vector3f(u - dr.mulsign(fold, u), v - dr.mulsign(fold, v), z))
