"""The TOML beside a mesh: what a user says of a spacecraft that its mesh file does not.

``docs/formats.md`` has every key. Nothing here opens the mesh.
"""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Literal

import numpy as np

from models.arrays import Floats
from models.dataset.marker_file import markers_of
from models.errors import DatasetError, UnreadableError
from models.markers import MarkerPattern
from models.materials import MATERIALS, BandReflectance, Material
from models.reading.bounds import LENGTH_M, UNIT
from models.reading.fields import Fields
from models.reading.nesting import check_toml_nesting
from models.reading.regular_file import read_lines
from models.reading.shown import shown, shown_line
from models.spacecraft.catalogue import SPACECRAFT
from models.spacecraft.own.mesh_file import IN_METRES, SUFFIXES

MOST_TOML_BYTES = 1_000_000
UNITS_M = {"m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0, "in": 0.0254, "ft": 0.3048}
DEFAULT_MATERIAL = "white_paint"
AXES = {
    f"{sign}{name}": (1.0 if sign == "+" else -1.0) * np.eye(3)[k]
    for k, name in enumerate("xyz")
    for sign in "+-"
}
KEYS = (
    "unit", "material", "smooth_deg", "origin", "centre_of_mass_in_mesh_m", "mass_kg",
    "inertia_kg_m2", "axes", "parts", "materials", "wireframe", "markers",
)  # fmt: skip
WIREFRAME_KEYS = (
    "file", "landmarks", "edges", "find", "sharp_deg", "most_landmarks", "most_edges",
    "most_triangles", "symmetries",
)  # fmt: skip
MOST_PARTS, MOST_LANDMARKS, MOST_EDGES = 1000, 1000, 5000
MOST_MASS_KG, MOST_MOMENT = 1e7, 1e12
LEAST_LANDMARKS = 4  # from fewer no pose without a second answer


@dataclass(frozen=True, eq=False)
class WireframeWish:
    """How the wireframe comes about.

    Attributes
    ----------
    file : str or None
        A wireframe.json beside the TOML, and nothing else.
    landmarks : dict of str to (3,) array, m
        In the target frame.
    edges : tuple of (str, str)
        Between landmarks by their names.
    find : bool
        Whether corners and edges are looked for on the mesh, too.
    sharp_deg : float, deg
        Faces that meet at more than this make an edge.
    most_landmarks, most_edges, most_triangles : int
        How many are kept, the largest first.
    symmetries : bool
        Whether turns that carry the wireframe onto itself are looked for.
    """

    file: str | None = None
    landmarks: Mapping[str, Floats] = field(default_factory=lambda: MappingProxyType({}))
    edges: tuple[tuple[str, str], ...] = ()
    find: bool = True
    sharp_deg: float = 25.0
    most_landmarks: int = 60
    most_edges: int = 100
    most_triangles: int = 600
    symmetries: bool = True


@dataclass(frozen=True, eq=False)
class OwnDescription:
    """What the TOML says.

    Attributes
    ----------
    where : str
        The TOML, for messages.
    folder : Path
        From which it names files.
    name : str
        Of the spacecraft.
    mesh : str
        The mesh file, beside the TOML.
    unit_m : float, m
        One unit of the mesh file.
    rotation : (3, 3) array
        ``target_from_mesh``.
    origin : str or (3,) array, m
        ``centre_of_mass``, ``mesh``, or a place in the mesh's axes.
    centre_of_mass_in_mesh_m : (3,) array or None, m
        In the mesh's axes; None: that of a skin of even thickness.
    mass_kg : float or None
    inertia_kg_m2 : (3, 3) array or None
        About the centre of mass, target axes; None: that of a skin of even thickness.
    material : str or None
        Of parts of which neither the TOML nor the mesh says anything.
    part_materials : dict of str to str
        By part, or by a pattern with ``*``.
    materials : dict of str to Material
        The user's own.
    smooth_deg : float, deg
        Faces that meet at less are shaded as one curved surface; 0: none are.
    wireframe : WireframeWish
    markers : MarkerPattern, str or None
        A markers.toml beside the TOML where it is text.
    """

    where: str
    folder: Path
    name: str
    mesh: str
    unit_m: float
    rotation: Floats
    origin: Literal["centre_of_mass", "mesh"] | Floats
    centre_of_mass_in_mesh_m: Floats | None
    mass_kg: float | None
    inertia_kg_m2: Floats | None
    material: str | None
    part_materials: Mapping[str, str]
    materials: Mapping[str, Material]
    smooth_deg: float
    wireframe: WireframeWish
    markers: MarkerPattern | str | None

    @property
    def mesh_path(self) -> Path:
        """Where the mesh lies."""
        return Path(os.path.normpath(self.folder / self.mesh))


def read_lines_of(path: Path) -> tuple[str, ...]:
    """Return the lines of a spacecraft's TOML, as a scenario keeps them.

    Raises
    ------
    UnreadableError
        If it is not there, no regular file, too large, or no UTF-8.
    """
    try:
        return tuple(read_lines(path, MOST_TOML_BYTES))
    except UnreadableError as error:
        if path.exists():
            raise
        raise UnreadableError(
            path,
            f"expected the TOML of a spacecraft, got: {error.told}; `rvbench inspect MESH` writes "
            "one beside a mesh, `rvbench list` shows the targets that need none",
        ) from error


def description_of(lines: tuple[str, ...], where: str, folder: Path) -> OwnDescription:
    """Read a spacecraft's TOML from its lines.

    Parameters
    ----------
    lines : tuple of str
    where : str
        Where they stand, for messages.
    folder : Path
        From which they name files.

    Raises
    ------
    UnreadableError
        If it is no TOML.
    DatasetError
        If a key is unknown or missing, or a value cannot be.
    """
    text = "\n".join(lines)
    check_toml_nesting(Path(where), text)
    try:
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise UnreadableError(where, shown_line(str(error))) from error
    return _description(Fields(table, where), where, folder)


def _description(fields: Fields, where: str, folder: Path) -> OwnDescription:
    fields.only(("name", "mesh"), KEYS)
    own = _materials(fields)
    known = {*MATERIALS, *own}
    return OwnDescription(
        where=where,
        folder=folder,
        name=_name(fields),
        mesh=_file(fields, "mesh", SUFFIXES),
        unit_m=_unit_m(fields),
        rotation=_rotation(fields),
        origin=_origin(fields),
        centre_of_mass_in_mesh_m=_vector(fields, "centre_of_mass_in_mesh_m"),
        mass_kg=fields.number("mass_kg", 0.0, MOST_MASS_KG, above=0.0, unit="kg")
        if "mass_kg" in fields
        else None,
        inertia_kg_m2=_inertia(fields),
        material=_material_name(fields, "material", known) if "material" in fields else None,
        part_materials=_part_materials(fields, known),
        materials=own,
        smooth_deg=fields.number("smooth_deg", 0.0, 90.0) if "smooth_deg" in fields else 30.0,
        wireframe=_wish(fields),
        markers=_markers(fields),
    )


def _name(fields: Fields) -> str:
    name = fields.text("name", 60)
    if name in SPACECRAFT:
        raise fields.refusal("name", "as a name of its own", f"{name!r}, which is a preset's")
    if not name.strip() or name.lower().endswith((".toml", ".json")):
        raise fields.refusal("name", "as a name, and not that of a file", shown(name))
    return name


def _file(fields: Fields, key: str, suffixes: tuple[str, ...]) -> str:
    name = fields.text(key, 500)
    if not name.lower().endswith(suffixes):
        raise fields.refusal(key, f"as a file {', '.join(suffixes)} beside this one", shown(name))
    return name


def _unit_m(fields: Fields) -> float:
    if "unit" in fields:
        return UNITS_M[fields.choice("unit", UNITS_M)]
    mesh = fields.text("mesh", 500)
    if mesh.lower().endswith(IN_METRES):
        return 1.0
    raise fields.refusal(
        "unit",
        f"as one of {', '.join(UNITS_M)}, for {mesh} does not say what one unit of it is",
        "none; `rvbench inspect` tells its size in each",
    )


def _rotation(fields: Fields) -> Floats:
    """Return ``target_from_mesh``: each row is a target axis in the mesh's axes."""
    if "axes" not in fields:
        return np.eye(3)
    axes = fields.table("axes")
    axes.only(("x", "y", "z"))
    matrix = np.array([AXES[axes.choice(name, AXES)] for name in "xyz"])
    if not np.isclose(np.linalg.det(matrix), 1.0):
        raise fields.refusal(
            "axes",
            "as three different axes of the mesh, right-handed",
            ", ".join(axes.text(name) for name in "xyz"),
        )
    return matrix


def _origin(fields: Fields) -> Literal["centre_of_mass", "mesh"] | Floats:
    if "origin" not in fields:
        return "centre_of_mass"
    if isinstance(fields.value("origin"), list):
        return fields.vector("origin", 3, *LENGTH_M)
    word = fields.choice("origin", ("centre_of_mass", "mesh"))
    return "mesh" if word == "mesh" else "centre_of_mass"


def _vector(fields: Fields, key: str) -> Floats | None:
    return fields.vector(key, 3, *LENGTH_M) if key in fields else None


def _inertia(fields: Fields) -> Floats | None:
    if "inertia_kg_m2" not in fields:
        return None
    matrix = fields.numbers("inertia_kg_m2", (3, 3), -MOST_MOMENT, MOST_MOMENT)
    moments = np.linalg.eigvalsh(0.5 * (matrix + matrix.T))
    if not np.allclose(matrix, matrix.T) or moments[0] <= 0 or moments[2] > moments[:2].sum():
        raise fields.refusal(
            "inertia_kg_m2",
            "as a body's: symmetric, its principal moments above zero and the largest at most the "
            "sum of the others",
            f"moments {moments.tolist()}",
        )
    return matrix


def _material_name(fields: Fields, key: str, known: set[str]) -> str:
    return fields.choice(key, sorted(known))


def _part_materials(fields: Fields, known: set[str]) -> dict[str, str]:
    if "parts" not in fields:
        return {}
    parts = fields.table("parts")
    return {name: parts.choice(name, sorted(known)) for name in parts.names(MOST_PARTS)}


def _materials(fields: Fields) -> dict[str, Material]:
    if "materials" not in fields:
        return {}
    tables, own = fields.table("materials"), {}
    for name in tables.names(MOST_PARTS, 60):
        table = tables.table(name)
        table.only(("diffuse",), ("specular", "roughness", "dielectric", "source"))
        if name in MATERIALS:
            raise tables.refusal(name, "under a name of its own", "that of one of the house")
        try:
            own[name] = Material(
                name=name,
                diffuse=_bands(table, "diffuse"),
                specular=_bands(table, "specular"),
                roughness=table.number("roughness", 0.05, 1.0) if "roughness" in table else 0.3,
                source=table.text("source", 1000) if "source" in table else "the user's own",
                is_dielectric=table.flag("dielectric") if "dielectric" in table else False,
            )
        except ValueError as error:
            raise DatasetError(f"{fields.where}: materials.{error}") from error
    return own


def _bands(table: Fields, key: str) -> BandReflectance:
    """Return a reflectance: one number for all bands, or three (sunlight, 800 nm, 850 nm)."""
    if key not in table:
        return BandReflectance(0.0, 0.0, 0.0)
    if isinstance(table.value(key), list):
        return BandReflectance(*table.vector(key, 3, *UNIT).tolist())
    value = table.number(key, *UNIT)
    return BandReflectance(value, value, value)


def _wish(fields: Fields) -> WireframeWish:
    if "wireframe" not in fields:
        return WireframeWish()
    table, default = fields.table("wireframe"), WireframeWish()
    table.only((), WIREFRAME_KEYS)
    if "file" in table:
        table.only(("file",))
        return WireframeWish(file=_file(table, "file", (".json",)), find=False)
    landmarks = {}
    if "landmarks" in table:
        points = table.table("landmarks")
        names = points.names(MOST_LANDMARKS, 60)
        landmarks = {name: points.vector(name, 3, *LENGTH_M) for name in names}
    edges = _edges(table, landmarks)
    find = table.flag("find") if "find" in table else not edges
    if not find and (len(landmarks) < LEAST_LANDMARKS or not edges):
        raise table.refusal(
            "find",
            f"as true, or at least {LEAST_LANDMARKS} landmarks and the edges between them",
            f"{len(landmarks)} landmarks and {len(edges)} edges",
        )

    def whole(key: str, low: int, high: int) -> int:
        return table.whole(key, low, high) if key in table else int(getattr(default, key))

    return WireframeWish(
        landmarks=MappingProxyType(landmarks),
        edges=edges,
        find=find,
        sharp_deg=table.number("sharp_deg", 5.0, 85.0)
        if "sharp_deg" in table
        else default.sharp_deg,
        most_landmarks=whole("most_landmarks", LEAST_LANDMARKS, MOST_LANDMARKS),
        most_edges=whole("most_edges", 3, MOST_EDGES),
        most_triangles=whole("most_triangles", 12, 20_000),
        symmetries=table.flag("symmetries") if "symmetries" in table else True,
    )


def _edges(table: Fields, landmarks: Mapping[str, Floats]) -> tuple[tuple[str, str], ...]:
    """Return edges from rows of names: ``["a", "b", "c"]`` is a line from a by b to c."""
    edges: list[tuple[str, str]] = []
    for row in table.items("edges", MOST_EDGES) if "edges" in table else []:
        if not isinstance(row, list) or len(row) < 2 or len(row) > MOST_EDGES:
            raise table.refusal("edges", "as lists of landmarks' names", shown(row))
        for name in row:
            if not isinstance(name, str) or name not in landmarks:
                raise table.refusal("edges", "between wireframe.landmarks by name", shown(name))
        edges.extend(pairwise(row))
    return tuple(edges)


def _markers(fields: Fields) -> MarkerPattern | str | None:
    if "markers" not in fields:
        return None
    if isinstance(fields.value("markers"), str):
        return _file(fields, "markers", (".toml",))
    return markers_of(fields.table("markers"))
