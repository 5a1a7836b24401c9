"""The scenario's tables of surfaces that differ from what the house says of their material."""

from __future__ import annotations

import difflib
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from pydantic import Field

from models.errors import ScenarioError
from models.materials import MOST_OF_A_FACE, BandReflectance, Material
from models.surface_detail import MOST_CREASED
from renders.scenario.table import Name, Table

if TYPE_CHECKING:
    from models.spacecraft.part import Spacecraft

LEAST_ROUGHNESS, MOST_ROUGHNESS = 0.05, 1.0  # see ``models.materials.Material``


class SurfaceTable(Table):
    """How a material of the target differs from what is said of it, as one specimen from another.

    Reflectances never exceed 1 in all, where a surface's detail is brightest, nor roughness its
    range: they stop there, and creases with a roughness that would not hold them.
    """

    material: Name = Field(description="of the target, such as mli_gold")
    diffuse: float = Field(1.0, ge=0, le=10, description="factor on the Lambertian part")
    specular: float = Field(1.0, ge=0, le=10, description="factor on the mirror part")
    roughness: float = Field(1.0, ge=0.05, le=20, description="factor on the roughness")


def varied(material: Material, table: SurfaceTable) -> Material:
    """Return a material as a table has it."""
    most = MOST_OF_A_FACE if material.is_dielectric else 1.0
    diffuse = [table.diffuse * value for value in material.diffuse.bands]
    specular = [min(table.specular * value, most) for value in material.specular.bands]
    detail = material.detail
    room = 1.0 / ((1.0 + detail.mottling) * (1.0 + detail.tile_spread))  # of the brightest place
    excess = max(one + other for one, other in zip(diffuse, specular, strict=True)) / room
    shrink = 1.0 if excess <= 1.0 else (1.0 - 1e-9) / excess
    roughness = min(max(table.roughness * material.roughness, LEAST_ROUGHNESS), MOST_ROUGHNESS)
    creased = min(detail.crease_slope, (1.0 - 1e-9) * MOST_CREASED * roughness)
    return replace(
        material,
        diffuse=BandReflectance(*(shrink * value for value in diffuse)),
        specular=BandReflectance(*(shrink * value for value in specular)),
        roughness=roughness,
        detail=replace(detail, crease_slope=creased),
        source=f"{material.source}; varied by the scenario",
    )


def materials_of(target: Spacecraft) -> dict[str, Material]:
    """Return what a target's parts are made of, by name."""
    return {part.material: target.material_of(part) for part in target.parts}


def with_surfaces(target: Spacecraft, tables: Sequence[SurfaceTable], where: str) -> Spacecraft:
    """Return a target with its surfaces as some tables have them.

    Parameters
    ----------
    target : Spacecraft
    tables : sequence of SurfaceTable
    where : str
        For messages.

    Raises
    ------
    ScenarioError
        If it has no such material, or a material is told twice.
    """
    there = materials_of(target)
    for name, count in Counter(table.material for table in tables).items():
        if name not in there:
            near = difflib.get_close_matches(name, there, n=1)
            hint = f"; perhaps you meant {near[0]}" if near else ""
            raise ScenarioError(
                f"{where}: expected surface.material as one of {target.name}'s, "
                f"{', '.join(sorted(there))}; got {name!r}{hint}"
            )
        if count > 1:
            raise ScenarioError(
                f"{where}: expected each surface.material once, got {name!r} {count} times"
            )
    own = {table.material: varied(there[table.material], table) for table in tables}
    return replace(target, materials={**target.materials, **own})
