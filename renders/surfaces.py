"""Materials as Mitsuba BSDFs: a Lambertian part plus a GGX-rough mirror part, band by band.

No surface returns more than it receives, at any angle. A metal's two parts are constants whose sum
is at most 1. A dielectric's face reflects F(angle) by Fresnel's law, up to 1 at grazing incidence,
of what the Lambertian part rho leaves: ``rho + (1 - rho) F <= 1``, the same from both ends of a
path. Both blends are reciprocal.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from models.materials import Material


def _bands(values: Sequence[float], scale: float = 1.0) -> dict[str, Any]:
    return {"type": "rgb", "value": [value * scale for value in values]}


def _blend(matt: dict[str, Any], mirror: dict[str, Any], mirror_weight: float) -> dict[str, Any]:
    return {"type": "blendbsdf", "weight": mirror_weight, "first": matt, "second": mirror}


def _matt(values: Sequence[float], scale: float = 1.0) -> dict[str, Any]:
    return {"type": "diffuse", "reflectance": _bands(values, scale)}


def _mirror(roughness: float, **optics: Any) -> dict[str, Any]:
    return {"type": "roughconductor", "distribution": "ggx", "alpha": roughness, **optics}


def _metal(material: Material) -> dict[str, Any]:
    """Return parts whose weights in the blend cancel against what each reflects."""
    matt_share, mirror_share = max(material.diffuse.bands), max(material.specular.bands)
    if mirror_share == 0.0:
        return _matt(material.diffuse.bands)
    weight = mirror_share / (matt_share + mirror_share)
    mirror = _mirror(
        material.roughness,
        material="none",
        specular_reflectance=_bands(material.specular.bands, 1.0 / weight),
    )
    if matt_share == 0.0:
        return mirror
    return _blend(_matt(material.diffuse.bands, 1.0 / (1.0 - weight)), mirror, weight)


def _dielectric(material: Material) -> dict[str, Any]:
    """Return a face of glass over the Lambertian part: a conductor that does not absorb."""
    face = _mirror(
        material.roughness,
        eta=_bands(material.refractive_indices),
        k=_bands((0.0, 0.0, 0.0)),
    )
    share = material.matt_share
    if share == 0.0:
        return face
    return _blend(_matt(material.diffuse.bands, 1.0 / share), face, 1.0 - share)


def bsdf_dict(material: Material, two_sided: bool = True) -> dict[str, Any]:
    """Return a material for ``mi.load_dict``; its two parts add up, band by band."""
    bsdf = _dielectric(material) if material.is_dielectric else _metal(material)
    return {"type": "twosided", "bsdf": bsdf} if two_sided else bsdf
