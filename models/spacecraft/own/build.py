"""A user's own spacecraft, built: its TOML and its mesh as the parts that presets are made of."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from types import MappingProxyType

import numpy as np

from models.arrays import Floats, Mask
from models.dataset.marker_file import read_markers
from models.errors import DatasetError, ScenarioError
from models.materials import Material
from models.reading.regular_file import read_bytes, state_of
from models.spacecraft.own.description import (
    DEFAULT_MATERIAL,
    OwnDescription,
    description_of,
    read_lines_of,
)
from models.spacecraft.own.found_wireframe import found_wireframe
from models.spacecraft.own.looks import material_from_look, shades
from models.spacecraft.own.mesh_file import MeshFile, Piece, read_mesh_file
from models.spacecraft.own.shading import shading_of
from models.spacecraft.own.skin import inertia_of, skin_of, triangle_areas
from models.spacecraft.own.welded import Welded, welded
from models.spacecraft.own_markers import with_own_markers
from models.spacecraft.part import Part, Spacecraft
from models.wireframe.wireframe import Wireframe
from models.wireframe.wireframe_file import MOST_BYTES, read_wireframe

MOST_PART_NAMES = 200  # labels of an image have eight bits, and the bench has names of its own
OF_THE_BENCH = ("retroreflectors", "chaser")
ONE_NAME = "body"  # of a mesh whose file has no names
LARGEST_M, SMALLEST_M = 1000.0, 0.001  # from corner to corner of its box
MOST_KEPT = 4


@dataclass(frozen=True, eq=False)
class OwnTarget:
    """A user's own spacecraft.

    Attributes
    ----------
    description : OwnDescription
    spacecraft : Spacecraft
        In the target frame.
    wireframe : Wireframe or None
    wireframe_fault : str
        Why there is none; empty where there is one.
    mass_kg : float
    inertia_kg_m2 : (3, 3) array, kg m2
        About the centre of mass, target axes.
    files_sha256 : str
        Of the mesh, of the files that it names, and of those that the TOML names beside it.
    files : tuple of Path
        All of these.
    """

    description: OwnDescription
    spacecraft: Spacecraft
    wireframe: Wireframe | None
    wireframe_fault: str
    mass_kg: float
    inertia_kg_m2: Floats
    files_sha256: str
    files: tuple[Path, ...]

    @property
    def known_wireframe(self) -> Wireframe:
        """The wireframe, where it is needed.

        Raises
        ------
        ScenarioError
            If there is none; the message says what to do.
        """
        if self.wireframe is None:
            raise ScenarioError(self.wireframe_fault)
        return self.wireframe


@dataclass(frozen=True, eq=False)
class PlacedMesh:
    """A mesh file's pieces in the target frame, and the mass that goes with them.

    Attributes
    ----------
    triangles : tuple of (f, 3, 3) arrays, m
        One for each piece.
    names : tuple of str
        Of the part that each piece belongs to.
    centre_of_mass : (3,) array, m
    mass_kg : float
    inertia_kg_m2 : (3, 3) array
    """

    triangles: tuple[Floats, ...]
    names: tuple[str, ...]
    centre_of_mass: Floats
    mass_kg: float
    inertia_kg_m2: Floats

    @property
    def all_triangles(self) -> Floats:
        """(f, 3, 3) array, m: of all pieces."""
        return np.concatenate(self.triangles)


def read_own_target(path: Path) -> OwnTarget:
    """Read a spacecraft's TOML, and the mesh that it names.

    Raises
    ------
    DatasetError, ScenarioError
        If one of them cannot be used; the message names file and key.
    """
    return own_target(read_lines_of(path), str(path), path.parent.resolve())


_KEPT: dict[tuple[tuple[str, ...], str, Path], tuple[OwnTarget, list[tuple[int, ...]]]] = {}


def own_target(lines: tuple[str, ...], where: str, folder: Path) -> OwnTarget:
    """Build a spacecraft from the lines of its TOML, which takes seconds: kept while files stand.

    Parameters
    ----------
    lines : tuple of str
    where : str
        Where they stand, for messages.
    folder : Path
        From which they name files.

    Raises
    ------
    DatasetError, ScenarioError
        As ``read_own_target``.
    """
    key = (lines, where, folder)
    kept = _KEPT.pop(key, None)
    if kept is None or kept[1] != [state_of(path) for path in kept[0].files]:
        built = _built(lines, where, folder)
        kept = built, [state_of(path) for path in built.files]
    _KEPT[key] = kept
    if len(_KEPT) > MOST_KEPT:
        del _KEPT[next(iter(_KEPT))]
    return kept[0]


def _built(lines: tuple[str, ...], where: str, folder: Path) -> OwnTarget:
    described = description_of(lines, where, folder)
    mesh = read_mesh_file(described.mesh_path)
    placed = place(described, mesh)
    parts, materials = _parts(described, mesh, placed)
    craft = Spacecraft(
        described.name, parts, None, placed.centre_of_mass, MappingProxyType(materials)
    )
    markers = described.markers
    if isinstance(markers, str):
        markers = read_markers(folder / markers)
    if markers is not None:
        craft = with_own_markers(craft, markers)
    wireframe, fault = _wireframe(described, placed)
    return OwnTarget(
        description=described,
        spacecraft=craft,
        wireframe=wireframe,
        wireframe_fault=fault,
        mass_kg=placed.mass_kg,
        inertia_kg_m2=placed.inertia_kg_m2,
        files_sha256=_files_sha256(described, mesh),
        files=(*mesh.files, *_beside(described)),
    )


def _files_sha256(described: OwnDescription, mesh: MeshFile) -> str:
    digest = hashlib.sha256(mesh.sha256.encode())
    for path in _beside(described):
        digest.update(read_bytes(path, MOST_BYTES))
    return digest.hexdigest()


def _beside(described: OwnDescription) -> list[Path]:
    names = (described.markers, described.wireframe.file)
    return [described.folder / name for name in names if isinstance(name, str)]


def place(described: OwnDescription, mesh: MeshFile) -> PlacedMesh:
    """Put a mesh into the target frame.

    Parameters
    ----------
    described : OwnDescription
    mesh : MeshFile

    Raises
    ------
    DatasetError
        If it is of no size that a spacecraft has, or has no area.
    """
    in_mesh = [described.unit_m * piece.triangles for piece in mesh.pieces]
    everything = np.concatenate(in_mesh)
    size = float(np.linalg.norm(np.ptp(everything.reshape(-1, 3), axis=0)))
    if not SMALLEST_M <= size <= LARGEST_M:
        raise DatasetError(
            f"{described.where}: expected a spacecraft of {SMALLEST_M:g} to {LARGEST_M:g} m from "
            f"corner to corner, got {size:.4g} m; is its unit right?"
        )
    try:
        skin = skin_of(everything)
    except ValueError as error:
        raise DatasetError(f"{mesh.path}: {error}") from error
    told = described.centre_of_mass_in_mesh_m
    centre = skin.centre if told is None else told
    origin = np.zeros(3) if isinstance(described.origin, str) else described.origin
    if isinstance(described.origin, str) and described.origin == "centre_of_mass":
        origin = centre
    turn = described.rotation
    mass_kg, inertia = inertia_of(skin, described.mass_kg, centre)
    inertia = turn @ inertia @ turn.T
    if described.inertia_kg_m2 is not None:
        inertia = described.inertia_kg_m2
    names = part_names(mesh)
    return PlacedMesh(
        triangles=tuple((each - origin) @ turn.T for each in in_mesh),
        names=names,
        centre_of_mass=np.asarray(turn @ (centre - origin)) + 0.0,
        mass_kg=mass_kg,
        inertia_kg_m2=np.asarray(inertia),
    )


def part_names(mesh: MeshFile) -> tuple[str, ...]:
    """Return the name of the part that each piece belongs to.

    Exporters number the pieces of one mesh, and leave single ones without a name; of thousands of
    names only the first words are kept, so that at most two hundred parts are left.
    """
    names = [
        f"{piece.name}_" if piece.name in OF_THE_BENCH else piece.name for piece in mesh.pieces
    ]
    if len(set(names)) == 1 and names[0].startswith("geometry_"):
        return (ONE_NAME,) * len(names)
    if len(set(names)) <= MOST_PART_NAMES:
        return tuple(names)
    for length in (24, 16, 10, 6, 3, 1):
        short = tuple(name.rstrip("0123456789_.- ")[:length] or ONE_NAME for name in names)
        if len(set(short)) <= MOST_PART_NAMES:
            return short
    return (ONE_NAME,) * len(names)


def material_told(described: OwnDescription, name: str) -> str | None:
    """Return the material that a TOML gives a part: by its name, else by the first pattern."""
    if name in described.part_materials:
        return described.part_materials[name]
    for pattern, material in described.part_materials.items():
        if fnmatchcase(name, pattern):
            return material
    return None


def turned_outward(body: Welded) -> Welded:
    """Return a surface with every closed body that is inside out turned."""
    edges = body.edges
    closed = np.ones(int(body.bodies.max()) + 1, dtype=bool)
    open_edge = (edges.count != 2) | ~edges.against
    closed[body.bodies[edges.first[open_edge]]] = False
    a, b, c = np.moveaxis(body.points[body.faces] - body.points.mean(axis=0), 1, 0)
    volume = np.bincount(body.bodies, np.einsum("fi,fi->f", a, np.cross(b, c)))
    wrong = (closed & (volume < 0.0))[body.bodies]
    if not wrong.any():
        return body
    faces = np.where(wrong[:, None], body.faces[:, ::-1], body.faces)
    return Welded(body.points, faces, body.source, body.degenerate, body.twice)


def _parts(
    described: OwnDescription, mesh: MeshFile, placed: PlacedMesh
) -> tuple[tuple[Part, ...], dict[str, Material]]:
    parts: list[Part] = []
    materials = dict(described.materials)
    _check_part_names(described, placed.names)
    for piece, triangles, name in zip(mesh.pieces, placed.triangles, placed.names, strict=True):
        told = material_told(described, name)
        body = welded(triangles)
        if not len(body.faces):
            continue
        body = turned_outward(body)
        if told is not None or piece.look.red is None:
            kinds = [
                (told or described.material or DEFAULT_MATERIAL, np.ones(len(body.faces), bool))
            ]
        else:
            kinds = _by_look(piece, body, materials)
        shading = shading_of(body, described.smooth_deg)
        smooth = shading.normals is not None
        parts.extend(Part(name, shading.mesh_of(of), material, smooth) for material, of in kinds)
    return tuple(parts), materials


def _by_look(piece: Piece, body: Welded, materials: dict[str, Material]) -> list[tuple[str, Mask]]:
    """Return the materials of a piece that looks as its file says, and the faces of each."""
    look = piece.look
    assert look.red is not None
    red = look.red[body.source]
    values, shade = shades(red, triangle_areas(body.points[body.faces]))
    kinds = []
    for k, value in enumerate(values.tolist()):
        settings = f"red {value:.4f}, metallic {look.metallic:.3f}, roughness {look.roughness:.3f}"
        name = f"as the mesh has it ({settings})"
        materials[name] = material_from_look(name, value, look.metallic, look.roughness)
        kinds.append((name, shade == k))
    return kinds


def _check_part_names(described: OwnDescription, names: tuple[str, ...]) -> None:
    there = dict.fromkeys(names)
    for pattern in described.part_materials:
        if not any(name == pattern or fnmatchcase(name, pattern) for name in there):
            shown = ", ".join([*there][:12]) + (", ..." if len(there) > 12 else "")
            raise DatasetError(
                f"{described.where}: expected parts.{pattern!r} to be a part of {described.mesh}, "
                f"got none of that name; there are {shown}"
            )


def _wireframe(described: OwnDescription, placed: PlacedMesh) -> tuple[Wireframe | None, str]:
    """Return the wireframe, or why there is none: a target can be rendered without."""
    if described.wireframe.file is not None:
        return read_wireframe(described.folder / described.wireframe.file), ""
    names = tuple(dict.fromkeys(placed.names))
    part = np.concatenate(
        [
            np.full(len(triangles), names.index(name))
            for triangles, name in zip(placed.triangles, placed.names, strict=True)
        ]
    )
    try:
        found = found_wireframe(
            described.name, placed.all_triangles, part, names, described.wireframe
        )
    except ValueError as error:
        return None, f"{described.where}: {error}"
    return found, ""


def materials_used(craft: Spacecraft) -> Mapping[str, tuple[str, ...]]:
    """Return the materials of each part, by its name."""
    used: dict[str, dict[str, None]] = {}
    for part in craft.parts:
        used.setdefault(part.name, {})[part.material] = None
    return {name: tuple(kinds) for name, kinds in used.items()}
