"""What a mesh file says of its surfaces, and how the bench's bands follow from it.

A file for the eye knows red, green and blue, and nothing beyond. The bands lie at 790 to 860 nm;
red, of the three, is the nearest, so **each band gets the linear red of the base colour**. Gold
foil stays bright so, and blue cells dark. Where that is wrong, a material by name is right.

The rest is the metallic-roughness model of glTF 2.0 (Khronos Group 2021, appendix B): with base
colour b and metallic m, the Lambertian part is ``0.96 b (1 - m)``, the mirror part
``0.04 (1 - m) + b m``, and the GGX alpha is the square of the roughness.

Textures, and colours of vertices or faces, are averaged **over each face**, in linear light; the
faces of a part are then sorted into at most twelve shades, so that a dark cell on a bright body
stays dark however large the texture is that both are on. What is finer than a face is lost.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from models.arrays import Floats, Indices
from models.materials import BandReflectance, Material

MOST_SHADES = 12
SHADE_STEP = 0.02  # shades nearer than this are one
FACE = 0.04  # reflectance of a dielectric's face at normal incidence, glTF 2.0, appendix B
DARK_ENOUGH = 0.3  # a Lambertian part below which the face's Fresnel rise is worth telling
SMOOTHEST = 0.05  # as ``Material`` allows
INSIDE_A_FACE = np.array(
    [[1 / 3, 1 / 3, 1 / 3], [0.6, 0.2, 0.2], [0.2, 0.6, 0.2], [0.2, 0.2, 0.6]]
)  # barycentric: where a texture is looked at


@dataclass(frozen=True, eq=False)
class Look:
    """How a piece of a mesh looks, as its file says.

    Attributes
    ----------
    said : str
        What the file has: ``base colour``, ``texture``, ``vertex colours``; empty for nothing.
    red : (f,) array or None
        Linear red of each face, 0 to 1; None where the file says nothing.
    metallic, roughness : float
        As glTF has them, averaged over the piece.
    transparent : bool
        Whether the file has it so; it is rendered as if it were not.
    """

    said: str
    red: Floats | None = None
    metallic: float = 0.0
    roughness: float = 0.5
    transparent: bool = False


def look_of(mesh: Any) -> Look:
    """Return how a trimesh mesh looks.

    Parameters
    ----------
    mesh : trimesh.Trimesh
    """
    visual = mesh.visual
    if visual.kind == "texture":
        return _of_material(mesh, visual)
    if visual.kind in ("vertex", "face"):
        colours = np.asarray(visual.face_colors, dtype=np.float64)[:, :3] / 255.0
        if len(colours) == len(mesh.faces):
            return Look("vertex colours", linear(colours)[:, 0])
    return Look("")


def linear(srgb: Floats) -> Floats:
    """Return linear light of sRGB values, (...,) array of 0 to 1 (IEC 61966-2-1).

    Parameters
    ----------
    srgb : (...,) array
        0 to 1.
    """
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def material_from_look(name: str, red: float, metallic: float, roughness: float) -> Material:
    """Return the material that follows from a base colour; the module says how.

    Parameters
    ----------
    name : str
    red : float
        Linear red of the base colour.
    metallic, roughness : float
        As glTF has them.
    """
    red, metallic = float(np.clip(red, 0.0, 1.0)), float(np.clip(metallic, 0.0, 1.0))
    diffuse = (1.0 - FACE) * red * (1.0 - metallic)
    specular = FACE * (1.0 - metallic) + red * metallic
    alpha = float(np.clip(roughness**2, SMOOTHEST, 1.0))
    return Material(
        name=name,
        diffuse=BandReflectance(diffuse, diffuse, diffuse),
        specular=BandReflectance(specular, specular, specular),
        roughness=alpha,
        source="base colour of the mesh file: its linear red in every band, our estimate",
        is_dielectric=metallic == 0.0 and diffuse < DARK_ENOUGH,
    )


def shades(red: Floats, areas: Floats) -> tuple[Floats, Indices]:
    """Sort faces into a few shades.

    Parameters
    ----------
    red : (f,) array
    areas : (f,) array
        Of the faces, in any unit: large ones count for more.

    Returns
    -------
    values : (k,) array
        Rising; at most twelve.
    shade : (f,) array of int
        That of each face.
    """
    step = max(SHADE_STEP, float(np.ptp(red)) / MOST_SHADES * (1.0 + 1e-9))
    place = np.floor((red - red.min()) / step).astype(np.int64)
    used, shade = np.unique(place, return_inverse=True)
    weights = np.maximum(areas, 1e-12 * max(float(areas.max()), 1e-300))
    total = np.bincount(shade, weights, minlength=len(used))
    return np.bincount(shade, weights * red, minlength=len(used)) / total, shade


def _of_material(mesh: Any, visual: Any) -> Look:
    material, faces = visual.material, np.asarray(mesh.faces)
    pbr = hasattr(material, "metallicFactor")
    if not pbr and _is_nothing(material):
        return Look("")
    uv = _inside_faces(visual.uv, faces)
    red, said = np.full(len(faces), _red_factor(material, pbr)), "base colour"
    texture = material.baseColorTexture if pbr else material.image
    if texture is not None and uv is not None:
        red, said = red * linear(_sampled(texture, uv))[..., 0].mean(axis=1), "texture"
    if not pbr:
        shine = float(np.ravel(material.glossiness)[0]) if material.glossiness is not None else 0.0
        return Look(said, red, 0.0, (2.0 / (max(shine, 0.0) + 2.0)) ** 0.25)
    metallic = 1.0 if material.metallicFactor is None else float(material.metallicFactor)
    roughness = 1.0 if material.roughnessFactor is None else float(material.roughnessFactor)
    if material.metallicRoughnessTexture is not None and uv is not None:
        seen = _sampled(material.metallicRoughnessTexture, uv).mean(axis=(0, 1))
        roughness, metallic = roughness * float(seen[1]), metallic * float(seen[2])
    transparent = material.alphaMode == "BLEND"
    return Look(said, red, metallic, roughness, transparent)


def _is_nothing(material: Any) -> bool:
    """Tell whether trimesh made a material up: nameless, or with its grey image for a lost one."""
    from trimesh.visual.material import color_image

    if material.image is None:
        return getattr(material, "name", None) is None
    return bool(material.image == color_image())


def _red_factor(material: Any, pbr: bool) -> float:
    """Return the linear red of a material's colour; that of an OBJ's is taken as sRGB."""
    factor = material.baseColorFactor if pbr else material.diffuse
    if factor is None:
        return 1.0
    values = np.asarray(factor)
    red = float(values.ravel()[0]) / (255.0 if values.dtype.kind in "ui" else 1.0)
    return float(np.clip(red if pbr else linear(np.array(red)), 0.0, 1.0))


def _inside_faces(uv: Any, faces: Indices) -> Floats | None:
    """Return texture coordinates at four places in each face, (f, 4, 2)."""
    if uv is None or not len(uv):
        return None
    corners = np.nan_to_num(np.asarray(uv, dtype=np.float64))[faces]
    return np.einsum("kc,fcx->fkx", INSIDE_A_FACE, corners)


def _sampled(texture: Any, uv: Floats) -> Floats:
    """Return a texture's RGB, 0 to 1, at its coordinates, which repeat; (..., 3)."""
    pixels = np.asarray(texture.convert("RGB"), dtype=np.float64) / 255.0
    height, width = pixels.shape[:2]
    column = np.minimum((uv[..., 0] % 1.0 * width).astype(np.int64), width - 1)
    row = np.minimum(((1.0 - uv[..., 1]) % 1.0 * height).astype(np.int64), height - 1)
    return np.asarray(pixels[row, column])
