"""What is found from the Sun, and how much of it the lens therefore need not find."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import drjit as dr
import mitsuba as mi

from models.arrays import Radiance


@dataclass(frozen=True, eq=False)
class FromSun:
    """Light of one exposure that was found from its Suns.

    Attributes
    ----------
    images : mapping of (height * width,) float32 arrays, W m-2 sr-1
        By the name of a light group.
    paths_per_m2 : mapping of float, 1/m2
        That were followed, by the name of a group.
    chaser_paths_per_m2 : mapping of float, 1/m2
        The same of those that have met the chaser.
    is_chaser : Bool, optional
        By the number of a shape; None if those are not followed apart.
    """

    images: Mapping[str, Radiance] = field(default_factory=dict)
    paths_per_m2: Mapping[str, float] = field(default_factory=dict)
    chaser_paths_per_m2: Mapping[str, float] = field(default_factory=dict)
    is_chaser: Any = None

    def kernel(self) -> PathsPerArea:
        """Return what a kernel needs of it."""
        return PathsPerArea(self)


class PathsPerArea:
    """How many paths cross a square metre of sunlight, for a kernel.

    Parameters
    ----------
    found : FromSun
    """

    def __init__(self, found: FromSun) -> None:
        self.names = frozenset(found.paths_per_m2)
        self.still = {n: dr.opaque(mi.Float, each) for n, each in found.paths_per_m2.items()}
        moving = found.chaser_paths_per_m2
        self.by_chaser = {n: dr.opaque(mi.Float, each) for n, each in moving.items()}
        self.is_chaser = found.is_chaser

    def meets_chaser(self, shape: Any, active: Any) -> Any:
        """Tell whether shapes are the chaser's."""
        if self.is_chaser is None:
            return mi.Bool(False)
        return dr.gather(mi.Bool, self.is_chaser, dr.reinterpret_array(mi.UInt32, shape), active)

    def of(self, name: str, met_chaser: Any) -> Any:
        """Return the number for a group's paths, 1/m2.

        Parameters
        ----------
        name : str
        met_chaser : Bool
            Whether the path has met the chaser.
        """
        if self.is_chaser is None:
            return self.still[name]
        return dr.select(met_chaser, self.by_chaser[name], self.still[name])


NOTHING = FromSun()
