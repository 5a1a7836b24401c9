"""Materials as Mitsuba BSDFs: a Lambertian part plus a GGX-rough mirror part, band by band."""

from __future__ import annotations

from typing import Any

from models.materials import BandReflectance, Material


def _bands(reflectance: BandReflectance, scale: float = 1.0) -> dict[str, Any]:
    return {"type": "rgb", "value": [value * scale for value in reflectance.bands]}


def bsdf_dict(material: Material, two_sided: bool = True) -> dict[str, Any]:
    """Return a material for ``mi.load_dict``; its two parts add up, band by band."""
    diffuse_share = max(material.diffuse.bands)
    specular_share = max(material.specular.bands)
    mirror = {
        "type": "roughconductor",
        "material": "none",
        "distribution": "ggx",
        "alpha": material.roughness,
    }
    total = diffuse_share + specular_share
    bsdf: dict[str, Any]
    if specular_share == 0.0:
        bsdf = {"type": "diffuse", "reflectance": _bands(material.diffuse)}
    elif diffuse_share == 0.0:
        bsdf = {**mirror, "specular_reflectance": _bands(material.specular)}
    else:
        weight = specular_share / total
        bsdf = {
            "type": "blendbsdf",
            "weight": weight,
            "first": {
                "type": "diffuse",
                "reflectance": _bands(material.diffuse, 1.0 / (1.0 - weight)),
            },
            "second": {
                **mirror,
                "specular_reflectance": _bands(material.specular, 1.0 / weight),
            },
        }
    return {"type": "twosided", "bsdf": bsdf} if two_sided else bsdf
