"""Surfaces as data: how much each reflects, in each band, with its source."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class BandReflectance:
    """Reflectance in the three bands that one rendering carries.

    Attributes
    ----------
    sunlight : float
        Averaged over the camera's 790 to 860 nm passband.
    nir800, nir850 : float
        At the lamps' wavelengths.
    """

    sunlight: float
    nir800: float
    nir850: float

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not 0.0 <= value <= 1.0:
                raise ValueError(f"expected a reflectance between 0 and 1, got {name} = {value}")

    @property
    def bands(self) -> tuple[float, float, float]:
        """(sunlight, nir800, nir850): the renderer's three channels."""
        return (self.sunlight, self.nir800, self.nir850)


BLACK = BandReflectance(0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Material:
    """A Lambertian part plus a GGX-rough mirror part.

    Attributes
    ----------
    name : str
    diffuse : BandReflectance
        Hemispherical reflectance of the Lambertian part.
    specular : BandReflectance
        Reflectance of the mirror part.
    roughness : float
        GGX alpha of the mirror part; at least 0.05, below which a path tracer makes fireflies.
    source : str
        Where the numbers come from.
    """

    name: str
    diffuse: BandReflectance
    specular: BandReflectance
    roughness: float
    source: str

    def __post_init__(self) -> None:
        if not 0.05 <= self.roughness <= 1.0:
            raise ValueError(
                f"{self.name}: expected a roughness from 0.05 to 1, got {self.roughness}"
            )
        for diffuse, specular in zip(self.diffuse.bands, self.specular.bands, strict=True):
            if diffuse + specular > 1.0:
                raise ValueError(
                    f"{self.name}: expected diffuse and specular to sum to at most 1, "
                    f"got {diffuse} + {specular}"
                )


MATERIALS: dict[str, Material] = {}
