"""How much the faces of a target reflect, and how: what a flight computer knows of its surfaces.

A face's mean stands for foil, tiles and paint alike. Two sides of a sheet differ: a solar wing has
cells on one and black film on the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats


@dataclass(frozen=True, eq=False)
class Finish:
    """Reflectances of triangles, (f, 2) each: on the side of a triangle's normal, and on the other.

    Attributes
    ----------
    diffuse : (f, 2) array
        Share of the light that leaves in all directions alike (Lambert).
    mirror : (f, 2) array
        Share that leaves about the mirrored direction, at normal incidence.
    roughness : (f, 2) array
        Of that lobe (GGX), creases and tilts of all that the triangle stands for included.
    glass : (f, 2) array
        Share of the mirrored part that grows towards grazing incidence by Fresnel's law.

    Raises
    ------
    ValueError
        If shapes differ, a value does not lie between 0 and 1, or more leaves than comes.
    """

    diffuse: Floats
    mirror: Floats
    roughness: Floats
    glass: Floats

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if value.shape != self.diffuse.shape or value.ndim != 2 or value.shape[1] != 2:
                raise ValueError(f"expected finishes as (f, 2) arrays, got {name} {value.shape}")
            if not ((value >= 0.0) & (value <= 1.0)).all():
                raise ValueError(f"expected {name} of finishes between 0 and 1")
        if not (self.diffuse + self.mirror <= 1.0 + 1e-9).all():
            raise ValueError("expected finishes to reflect no more than 1, diffuse and mirror")

    def __len__(self) -> int:
        return len(self.diffuse)

    @property
    def table(self) -> Floats:
        """(f, 2, 4) array: diffuse, mirror, roughness and glass."""
        return np.stack([self.diffuse, self.mirror, self.roughness, self.glass], axis=-1)

    @classmethod
    def of(cls, table: Floats) -> Finish:
        """Return the finishes of an (f, 2, 4) table."""
        return cls(*np.moveaxis(table, -1, 0))
