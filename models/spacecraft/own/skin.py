"""Mass of a skin of even thickness: where a mesh's centre of mass and inertia lie if none is told.

Of a closed body the volume would do as well; of open sheets, of bodies within bodies and of faces
that look inwards only the skin has a mass that is sure to be right in kind.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats

SKIN_KG_M2 = 20.0  # a 10 m2 satellite of 200 kg; only ratios of moments matter to a free body


@dataclass(frozen=True, eq=False)
class Skin:
    """Mass properties of a mesh's surface.

    Attributes
    ----------
    area_m2 : float, m2
    centre : (3,) array, m
    inertia_per_kg : (3, 3) array, m2
        About the centre, of one kilogram.
    """

    area_m2: float
    centre: Floats
    inertia_per_kg: Floats


def triangle_areas(triangles: Floats) -> Floats:
    """Return the areas of triangles, (f,), in the square of their unit.

    Parameters
    ----------
    triangles : (f, 3, 3) array
    """
    sides = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return np.asarray(0.5 * np.linalg.norm(sides, axis=1))


def skin_of(triangles: Floats) -> Skin:
    """Return the mass properties of a skin.

    The second moment of a triangle of area A with corners v is ``A / 12 (sum v v^T + s s^T)``, s
    the sum of its corners.

    Parameters
    ----------
    triangles : (f, 3, 3) array, m

    Raises
    ------
    ValueError
        If they have no area.
    """
    areas = triangle_areas(triangles)
    total = float(areas.sum())
    if not total > 0.0:
        raise ValueError("expected faces with an area, got none")
    weights = areas / total
    centre = weights @ triangles.mean(axis=1)
    corners = triangles - centre
    sums = corners.sum(axis=1)
    second = np.einsum("f,fki,fkj->ij", weights, corners, corners)
    second = (second + np.einsum("f,fi,fj->ij", weights, sums, sums)) / 12.0
    inertia = np.trace(second) * np.eye(3) - second
    return Skin(total, np.asarray(centre), np.asarray(0.5 * (inertia + inertia.T)))


def inertia_of(skin: Skin, mass_kg: float | None, about: Floats) -> tuple[float, Floats]:
    """Return the mass of a skin, kg, and its inertia about a point, (3, 3) kg m2.

    Parameters
    ----------
    skin : Skin
    mass_kg : float or None
        None: 20 kg a square metre.
    about : (3,) array, m
    """
    mass = SKIN_KG_M2 * skin.area_m2 if mass_kg is None else mass_kg
    away = about - skin.centre
    shift = float(away @ away) * np.eye(3) - np.outer(away, away)
    return mass, np.asarray(mass * (skin.inertia_per_kg + shift))
