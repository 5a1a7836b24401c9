"""What there is to say of a mesh file: its size, its faults, its parts, its wireframe."""

from __future__ import annotations

import json
import os
import re
from dataclasses import dataclass
from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table

from models.errors import DatasetError, ScenarioError
from models.spacecraft.catalogue import SPACECRAFT
from models.spacecraft.own.build import (
    OwnTarget,
    PlacedMesh,
    material_told,
    materials_used,
    own_target,
    place,
)
from models.spacecraft.own.description import DEFAULT_MATERIAL, UNITS_M, read_lines_of
from models.spacecraft.own.faults import Fault, Surface, faults_of, guessed_unit, size_of
from models.spacecraft.own.mesh_file import IN_METRES, SUFFIXES, MeshFile, read_mesh_file

NAME = re.compile(r"[^A-Za-z0-9_-]+")
BANDS = (
    "bands: what the mesh says is for the eye; each band, all of 790 to 860 nm, gets the linear "
    "red of its base colour, textures averaged over each face (docs/formats.md)"
)


@dataclass(frozen=True, eq=False)
class Inspection:
    """A mesh file and the spacecraft that comes of it.

    Attributes
    ----------
    mesh : MeshFile
    surface : Surface
    faults : list of Fault
        The worst first.
    target : OwnTarget
    placed : PlacedMesh
    unit_is_guessed : bool
    own_toml : Path or None
        The TOML that was inspected; None where a mesh was, without one.
    """

    mesh: MeshFile
    surface: Surface
    faults: list[Fault]
    target: OwnTarget
    placed: PlacedMesh
    unit_is_guessed: bool
    own_toml: Path | None


def inspect_file(path: Path, out: Path) -> Inspection:
    """Inspect a mesh file, or a spacecraft's TOML and the mesh that it names.

    Parameters
    ----------
    path : Path
    out : Path
        The folder into which a TOML will be written, from which it names the mesh.

    Raises
    ------
    DatasetError, ScenarioError
        If it is neither, or cannot be read.
    """
    if path.suffix.lower() == ".toml":
        lines = read_lines_of(path)
        return _inspected(lines, str(path), path.parent.resolve(), path)
    if path.suffix.lower() not in SUFFIXES:
        raise DatasetError(
            f"expected a mesh file, {', '.join(SUFFIXES)}, or the .toml beside one, got {path}"
        )
    mesh = read_mesh_file(path)
    unit = guessed_unit(mesh)
    lines = (
        f"name = {json.dumps(start_name(path))}",
        f"mesh = {json.dumps(os.path.relpath(path.resolve(), out.resolve()))}",
        f'unit = "{unit}"',
    )
    return _inspected(lines, str(path), out.resolve(), None)


def start_name(path: Path) -> str:
    """Return a name for the spacecraft of a mesh file, which no preset has."""
    name = NAME.sub("-", path.stem).strip("-")[:60] or "spacecraft"
    return f"own-{name}" if name in SPACECRAFT else name


def print_inspection(found: Inspection, console: Console) -> None:
    """Print what was found."""
    mesh, surface, target = found.mesh, found.surface, found.target
    described = target.description
    unit = next(name for name, value in UNITS_M.items() if value == described.unit_m)
    sides = " x ".join(f"{side:.3g}" for side in described.unit_m * size_of(mesh))
    guess = ", a guess" if found.unit_is_guessed else ""
    rows = [
        ("file", str(mesh.path)),
        ("parts", f"{len({*found.placed.names})}, of {surface.bodies} connected bodies"),
        ("surface", f"{surface.faces} faces, {surface.points} corners once welded"),
        ("size", f"{sides} m (unit: {unit}{guess})"),
        ("mass", _mass_line(found)),
        ("wireframe", _wireframe_line(target)),
    ]
    facts = Table(box=box.SIMPLE, show_header=False)
    facts.add_column(style="bold", no_wrap=True)
    facts.add_column(overflow="fold")
    for row in rows:
        facts.add_row(*row)
    console.print(facts)
    console.print(_part_table(found))
    if any(piece.look.red is not None for piece in mesh.pieces):
        console.print(BANDS, soft_wrap=True, markup=False, highlight=False)
    for fault in found.faults:
        word = "mend" if fault.kind == "mend" else "know"
        text = f"{word}: {fault.what}" + (f"; {fault.todo}" if fault.todo else "")
        console.print(text, soft_wrap=True, markup=False, highlight=False)
    if not found.faults:
        console.print("nothing is wrong with the mesh")


def _inspected(
    lines: tuple[str, ...], where: str, folder: Path, own_toml: Path | None
) -> Inspection:
    target = own_target(lines, where, folder)
    described = target.description
    mesh = read_mesh_file(described.mesh_path)
    is_guess = own_toml is None and mesh.path.suffix.lower() not in IN_METRES
    unit = next(name for name, value in UNITS_M.items() if value == described.unit_m)
    surface = Surface.of(mesh)
    faults = faults_of(
        mesh,
        surface,
        unit=None if is_guess else unit,
        centre_of_mass_in_mesh_m=described.centre_of_mass_in_mesh_m,
    )
    return Inspection(mesh, surface, faults, target, place(described, mesh), is_guess, own_toml)


def _mass_line(found: Inspection) -> str:
    described, placed = found.target.description, found.placed
    told = described.inertia_kg_m2 is not None
    how = "as told" if told else "of a skin of even thickness"
    diagonal = ", ".join(f"{placed.inertia_kg_m2[k, k]:.4g}" for k in range(3))
    centre = ", ".join(f"{x:.3g}" for x in placed.centre_of_mass)
    return (
        f"{placed.mass_kg:.4g} kg, diagonal of the inertia {diagonal} kg m2 {how}; centre of mass "
        f"at ({centre}) m in the target frame"
    )


def _wireframe_line(target: OwnTarget) -> str:
    frame = target.wireframe
    if frame is None:
        return f"none: {target.wireframe_fault}"
    turns = f"; {len(frame.symmetries)} symmetries: poses that differ by one cannot be told apart"
    return (
        f"{len(frame)} landmarks, {len(frame.edges)} edges, {len(frame.triangles_in_target)} "
        f"faces that hide{turns if frame.symmetries else ''}"
    )


def _part_table(found: Inspection) -> Table:
    table = Table(box=box.SIMPLE)
    for heading in ("part", "faces", "material", "said by"):
        table.add_column(heading, overflow="fold")
    described, craft = found.target.description, found.target.spacecraft
    faces: dict[str, int] = {}
    for part in craft.parts:
        faces[part.name] = faces.get(part.name, 0) + len(part.mesh.faces)
    looks = {
        name: piece.look.said
        for name, piece in zip(found.placed.names, found.mesh.pieces, strict=True)
    }
    used = materials_used(craft)
    for name in [*faces][:40]:
        kinds = used[name]
        if material_told(described, name) is not None:
            by = "the TOML"
        elif looks[name]:
            by = f"the mesh: {looks[name]}"
        else:
            by = "the TOML" if described.material else f"nobody: {DEFAULT_MATERIAL}"
        shown = kinds[0] if len(kinds) == 1 else f"{len(kinds)} shades"
        table.add_row(name, str(faces[name]), shown, by)
    if len(faces) > 40:
        table.add_row(f"and {len(faces) - 40} more", "", "", "")
    return table


def title_of(found: Inspection) -> str:
    """Return what stands over the picture: name, size, faces."""
    described, surface = found.target.description, found.surface
    sides = " x ".join(f"{side:.3g}" for side in described.unit_m * size_of(found.mesh))
    guess = ", a guess" if found.unit_is_guessed else ""
    parts = len({*found.placed.names})
    return (
        f"{described.name}: {sides} m{guess}; {surface.faces} faces in {parts} "
        f"part{'s' if parts > 1 else ''}"
    )


def check_start_place(toml: Path) -> None:
    """Refuse to write a TOML over what is there.

    Raises
    ------
    ScenarioError
    """
    if os.path.lexists(toml):
        raise ScenarioError(
            f"expected nothing at {toml} yet, there is something; nothing was changed: "
            f"`rvbench inspect {toml}` looks at it, or name another folder with --out"
        )
