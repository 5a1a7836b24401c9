"""Where sunlight landed after it had bounced."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from models.arrays import AnyArray

COLUMNS = 4096  # of the image that landings are kept in


@dataclass(frozen=True, eq=False)
class Landed:
    """Landings of paths from a Sun, in the order in which they were followed.

    Attributes
    ----------
    places : (n, 3) float32 array, m
        Target frame.
    direction : (n,) uint32 array
        From which the light came; see ``packed``.
    power_w : (n,) float32 array, W
    ratio : (n,) float32 array, 1/m2
        See ``weights``: of the densities with which what comes before is found, from the Sun over
        from the lens.
    """

    places: AnyArray
    direction: AnyArray
    power_w: AnyArray
    ratio: AnyArray

    CHANNELS: ClassVar = ("x", "y", "z", "direction", "power_w", "ratio")

    def __len__(self) -> int:
        return len(self.power_w)

    @classmethod
    def joined(cls, parts: Sequence[Landed]) -> Landed:
        """Return all of several, in order."""
        none = cls(np.empty((0, 3), "f4"), np.empty(0, "u4"), np.empty(0, "f4"), np.empty(0, "f4"))
        every = [none, *parts]
        return cls(
            np.concatenate([each.places for each in every]),
            np.concatenate([each.direction for each in every]),
            np.concatenate([each.power_w for each in every]),
            np.concatenate([each.ratio for each in every]),
        )

    def channels(self) -> dict[str, AnyArray]:
        """Return them as an image of a file, rows of ``COLUMNS``, the last filled up.

        Returns
        -------
        dict of (rows, 4096) arrays
            By the names of ``CHANNELS``; what fills up has no power.
        """
        rows = max(1, -(-len(self) // COLUMNS))
        columns = (*self.places.T, self.direction, self.power_w, self.ratio)
        filled = {}
        for name, values in zip(self.CHANNELS, columns, strict=True):
            filled[name] = np.zeros(rows * COLUMNS, dtype=values.dtype)
            filled[name][: len(self)] = values
        return {name: values.reshape(rows, COLUMNS) for name, values in filled.items()}

    @classmethod
    def of_channels(cls, channels: Mapping[str, AnyArray]) -> Landed:
        """Return them from such an image.

        Parameters
        ----------
        channels : mapping of (rows, 4096) arrays
        """
        x, y, z, direction, power, ratio = (channels[name].ravel() for name in cls.CHANNELS)
        there = power > 0.0
        places = np.stack([x, y, z], axis=1)
        return cls(places[there], direction[there], power[there], ratio[there])
