"""The ray that leaves a surface, from as near to it as 32 bits allow."""

from __future__ import annotations

from typing import Any

import drjit as dr
import mitsuba as mi

START_PER_M = 2e-6  # a hit's place is exact to some 2e-7 of its largest coordinate


def leaving(place: Any, normal: Any, direction: Any) -> Any:
    """Return the ray that leaves a surface, from as near to it as 32 bits allow.

    Mitsuba's own ``spawn_ray`` starts 45 times farther off, 0.4 mm at 4 m from the origin, and so
    loses the shadows of what is thin: gaps between solar cells, tabs, blankets' edges. Cycles
    showed it: cells 2.5 % too bright under S2, 60 % under the grazing S3.

    Parameters
    ----------
    place : Point3f, m
        On the surface, target frame.
    normal : Vector3f
        Unit, on the side that the ray leaves to.
    direction : Vector3f
        Unit.
    """
    return mi.Ray3f(place + normal * (START_PER_M * (1.0 + dr.max(dr.abs(place)))), direction)
