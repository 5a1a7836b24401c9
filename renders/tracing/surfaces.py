"""What a surface returns: a Lambertian part plus a GGX-rough mirror part, band by band.

No surface returns more than it receives, at any angle. A metal's two parts are constants whose sum
is at most 1. A dielectric's face reflects F(angle) by Fresnel's law, up to 1 at grazing incidence,
of what the Lambertian part rho leaves: ``rho + (1 - rho) F <= 1``, the same from both ends of a
path. Both are reciprocal.

The one-pass kernel reads these numbers from a table (``renders.tracing.surface_table``); scalar
variants get them as Mitsuba's own BSDFs, which tests hold against the table.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

from models.materials import Material
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from models.surface_detail import PLAIN, SurfaceDetail

Bands: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True)
class DiscPlace:
    """Where a retroreflector's disc lies, in the target frame.

    Attributes
    ----------
    centre : (float, float, float), m
    along, across : (float, float, float)
        Unit vectors in its plane; one of the cube's edges lies over ``along``.
    radius_m : float, m
    """

    centre: Bands
    along: Bands
    across: Bands
    radius_m: float


@dataclass(frozen=True)
class Surface:
    """A surface's lobes, ready for a renderer.

    Attributes
    ----------
    matt : tuple of 3 floats
        Reflectance of the Lambertian part in each band.
    mirror : tuple of 3 floats
        Factor of the mirror part, beside Fresnel's if there are ``indices``.
    roughness : float
        GGX alpha of the mirror part.
    indices : tuple of 3 floats or None
        Refractive indices of a dielectric's face; a metal has none.
    retroreflector : RetroreflectorOptics or None
        What comes back along the way it came, if anything does.
    two_sided : bool
        Whether the back is as the front; black if not.
    detail : SurfaceDetail
        What a pixel that resolves it sees beside the mean.
    disc : DiscPlace or None
        Where a retroreflector is, for its cube to be seen; an effective disc, unless given.
    """

    matt: Bands
    mirror: Bands
    roughness: float
    indices: Bands | None = None
    retroreflector: RetroreflectorOptics | None = None
    two_sided: bool = True
    detail: SurfaceDetail = PLAIN
    disc: DiscPlace | None = None

    @property
    def mirror_share(self) -> float:
        """How much of what is reflected at normal incidence the mirror part has."""
        if self.indices is None:
            mirror = max(self.mirror)
        else:
            faces = [((n - 1.0) / (n + 1.0)) ** 2 for n in self.indices]
            mirror = max(m * face for m, face in zip(self.mirror, faces, strict=True))
        return mirror / (mirror + max(self.matt)) if mirror > 0.0 else 0.0


def surface_of(material: Material) -> Surface:
    """Return the lobes of a material."""
    if not material.is_dielectric:
        bands = material.diffuse.bands, material.specular.bands
        return Surface(*bands, material.roughness, detail=material.detail)
    rest = 1.0 - material.matt_share
    first, second, third = material.refractive_indices
    indices = (first, second, third)
    bands = material.diffuse.bands, (rest, rest, rest)
    return Surface(*bands, material.roughness, indices, detail=material.detail)


def surface_of_disc(optics: RetroreflectorOptics, place: DiscPlace | None = None) -> Surface:
    """Return the lobes of a retroreflector's face, with what it sends back."""
    face = surface_of(optics.face)
    return replace(face, retroreflector=optics, two_sided=False, disc=place)


def _bands(values: Sequence[float], scale: float = 1.0) -> dict[str, Any]:
    return {"type": "rgb", "value": [value * scale for value in values]}


def _blend(matt: dict[str, Any], mirror: dict[str, Any], mirror_weight: float) -> dict[str, Any]:
    return {"type": "blendbsdf", "weight": mirror_weight, "first": matt, "second": mirror}


def _matt(values: Sequence[float], scale: float = 1.0) -> dict[str, Any]:
    return {"type": "diffuse", "reflectance": _bands(values, scale)}


def _mirror(roughness: float, **optics: Any) -> dict[str, Any]:
    return {"type": "roughconductor", "distribution": "ggx", "alpha": roughness, **optics}


def _metal(surface: Surface) -> dict[str, Any]:
    """Return parts whose weights in the blend cancel against what each reflects."""
    weight = surface.mirror_share
    if weight == 0.0:
        return _matt(surface.matt)
    mirror = _mirror(
        surface.roughness,
        material="none",
        specular_reflectance=_bands(surface.mirror, 1.0 / weight),
    )
    if weight == 1.0:
        return mirror
    return _blend(_matt(surface.matt, 1.0 / (1.0 - weight)), mirror, weight)


def _dielectric(surface: Surface, indices: Bands) -> dict[str, Any]:
    """Return a face of glass over the Lambertian part: a conductor that does not absorb."""
    face = _mirror(surface.roughness, eta=_bands(indices), k=_bands((0.0, 0.0, 0.0)))
    rest = surface.mirror[0]
    if rest == 1.0:
        return face
    return _blend(_matt(surface.matt, 1.0 / (1.0 - rest)), face, rest)


def bsdf_dict(surface: Surface) -> dict[str, Any]:
    """Return a surface for ``mi.load_dict``, but for what a retroreflector sends back."""
    indices = surface.indices
    bsdf = _metal(surface) if indices is None else _dielectric(surface, indices)
    return {"type": "twosided", "bsdf": bsdf} if surface.two_sided else bsdf
