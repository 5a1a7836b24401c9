"""What the faces of a wireframe are made of: finishes read off the mesh that stands behind them.

A wireframe's triangle stands for whatever lies about it: foil with its creases, panels, tiles. From
places spread over it rays go through it along its normal, from either side, and what each meets
first counts. The slope of what is met, and of the creases that no mesh has, widens the lobe.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices
from models.spacecraft.part import Spacecraft
from models.wireframe.finish import Finish
from models.wireframe.wireframe import Wireframe

RAYS = 48  # through each triangle, each way
ABOVE_M, BELOW_M = 0.25, 0.35  # of a triangle, between which a surface is taken for its own
STEEPEST = 0.5  # cosine: what is met at more than 60 deg is something else, seen edge on
STEPS = (0.7548776662466927, 0.5698402909980532)  # Roberts's R2 sequence


@dataclass(frozen=True, eq=False)
class FaceShares:
    """What is met on the sides of a wireframe's triangles.

    Attributes
    ----------
    materials : tuple of str
    shares : (f, 2, m) array
        By material, of the side of the triangle's normal and of the other; sums to 1, or to 0
        where nothing is met.
    slopes : (f, 2, m) array
        Mean square of the slope of what is met of each, towards the triangle.
    """

    materials: tuple[str, ...]
    shares: Floats
    slopes: Floats


def finish_of(
    met: FaceShares, spacecraft: Spacecraft, factors: dict[str, float] | None = None
) -> Finish:
    """Return the mean finish of what is met.

    Parameters
    ----------
    met : FaceShares
    spacecraft : Spacecraft
        Whose materials they are.
    factors : dict of str to float, optional
        By which a material's reflectance is multiplied, as far as it stays below 1.
    """
    known = {
        spacecraft.material_of(part).name: spacecraft.material_of(part) for part in spacecraft.parts
    }
    own = [known[name] for name in met.materials]
    scale = np.array([(factors or {}).get(name, 1.0) for name in met.materials])
    diffuse = np.array([material.diffuse.sunlight for material in own])
    mirror = np.array([material.specular.sunlight for material in own])
    scale = np.minimum(scale, 0.98 / np.maximum(diffuse + mirror, 1e-3))
    diffuse, mirror = scale * diffuse, scale * mirror
    creased = np.array([2.0 * material.detail.crease_slope**2 for material in own])
    rough = np.array([material.roughness**2 for material in own]) + creased
    glass = np.array([float(material.is_dielectric) for material in own])
    mirrored = met.shares * mirror
    total = np.maximum(mirrored.sum(axis=2), 1e-9)
    lobe = (mirrored * (rough + met.slopes)).sum(axis=2) / total
    return Finish(
        diffuse=met.shares @ diffuse,
        mirror=mirrored.sum(axis=2),
        roughness=np.sqrt(np.clip(lobe, 1e-3, 1.0)),
        glass=(mirrored @ glass) / total,
    )


def face_shares(wireframe: Wireframe, spacecraft: Spacecraft) -> FaceShares:
    """Return what is met on either side of a wireframe's triangles.

    Parameters
    ----------
    wireframe : Wireframe
    spacecraft : Spacecraft
        The same, in the same frame.
    """
    names = sorted({spacecraft.material_of(part).name for part in spacecraft.parts})
    mesh = np.concatenate([np.asarray(part.mesh.triangles) for part in spacecraft.parts])
    of = np.concatenate(
        [
            np.full(len(part.mesh.faces), names.index(spacecraft.material_of(part).name))
            for part in spacecraft.parts
        ]
    )
    normals = np.cross(mesh[:, 1] - mesh[:, 0], mesh[:, 2] - mesh[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-15)[:, None]
    low, high = mesh.min(axis=1), mesh.max(axis=1)
    count = len(wireframe.triangles_in_target)
    shares, slopes = np.zeros((count, 2, len(names))), np.zeros((count, 2, len(names)))
    for number, triangle in enumerate(wireframe.triangles_in_target):
        across = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
        if not np.linalg.norm(across) > 0.0:
            continue
        normal = across / np.linalg.norm(across)
        prism = np.concatenate([triangle + ABOVE_M * normal, triangle - ABOVE_M * normal])
        prism = np.concatenate([prism, triangle + BELOW_M * normal, triangle - BELOW_M * normal])
        near = (high >= prism.min(axis=0)).all(axis=1) & (low <= prism.max(axis=0)).all(axis=1)
        chosen = np.flatnonzero(near & (np.abs(normals @ normal) > STEEPEST))
        places = _places(triangle)
        for side, way in enumerate((1.0, -1.0)):
            met = _first(mesh[chosen], places, way * normal)
            met = chosen[met[met >= 0]]
            slope = 1.0 / (normals[met] @ normal) ** 2 - 1.0
            number_of = np.bincount(of[met], minlength=len(names))
            shares[number, side] = number_of / max(len(met), 1)
            slopes[number, side] = np.bincount(of[met], slope, len(names)) / np.maximum(
                number_of, 1
            )
    return FaceShares(tuple(names), shares, slopes)


def _places(triangle: Floats) -> Floats:
    u, v = ((0.5 + np.arange(1, RAYS + 1)[:, None] * np.array(STEPS)) % 1.0).T
    fold = u + v > 1.0
    u, v = np.where(fold, 1.0 - u, u), np.where(fold, 1.0 - v, v)
    sides = triangle[1:] - triangle[0]
    return np.asarray(triangle[0] + u[:, None] * sides[0] + v[:, None] * sides[1])


def _first(mesh: Floats, places: Floats, outward: Floats) -> Indices:
    """Return the triangle that is met first from outside over each place, -1 where none is.

    Parameters
    ----------
    mesh : (m, 3, 3) array, m
    places : (n, 3) array, m
    outward : (3,) array
        Unit vector, against which rays go.
    """
    if not len(mesh):
        return np.full(len(places), -1)
    helper = np.eye(3)[int(np.argmin(np.abs(outward)))]
    right = np.cross(helper, outward)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(outward, right), outward])
    corners, points = mesh @ axes.T, places @ axes.T
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    away = points[:, None, :2] - corners[None, :, 0, :2]
    u = (away[..., 0] * second[:, 1] - away[..., 1] * second[:, 0]) / area
    v = (first[:, 0] * away[..., 1] - first[:, 1] * away[..., 0]) / area
    height = corners[:, 0, 2] + u * first[:, 2] + v * second[:, 2] - points[:, None, 2]
    hit = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (height < ABOVE_M) & (height > -BELOW_M)
    height = np.where(hit, height, -np.inf)
    best = height.argmax(axis=1)
    return np.where(np.isfinite(height[np.arange(len(points)), best]), best, -1)
