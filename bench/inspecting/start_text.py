"""A spacecraft's TOML to start from: what is known of its mesh, and what else could be said."""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np

from models.materials import MATERIALS
from models.spacecraft.own.build import PlacedMesh
from models.spacecraft.own.description import DEFAULT_MATERIAL, UNITS_M, OwnDescription
from models.spacecraft.own.faults import size_of
from models.spacecraft.own.mesh_file import IN_METRES, MeshFile

MOST_PARTS_LISTED = 40
ROUNDING = 1e-9
HEAD = """\
# A spacecraft of your own: `target = "{file}"` in a scenario. docs/formats.md tells of every key.
# `#key = value` shows a default, or what was measured: take away the # to change it.

name = {name}
mesh = {mesh}
"""
MASS = """\

# Motion turns about the centre of mass; unless told, it is that of a skin of even thickness.
#origin = "centre_of_mass"          # or "mesh", or [x, y, z] in the mesh's axes, m
#centre_of_mass_in_mesh_m = {centre}
#mass_kg = {mass}
#inertia_kg_m2 = {inertia}   # about it, target axes

# The target's axes, each as one of the mesh's.
#[axes]
#x = "+x"
#y = "+y"
#z = "+z"
"""
REST = """\

# Your own materials: one number, or one each for sunlight, 800 nm and 850 nm.
#[materials.my_paint]
#diffuse = [0.80, 0.80, 0.79]
#specular = 0.02
#roughness = 0.4
#dielectric = false

# Corners and straight edges are found on the mesh, the largest first, unless you know better:
# file = "wireframe.json", or landmarks and the edges between them, in the target frame, m.
#[wireframe]
#sharp_deg = 25.0                   # faces that meet at more make an edge
#most_landmarks = 60
#most_edges = 100
#most_triangles = 600               # of the faces that hide: the pipeline's time goes with them
#symmetries = true

# Markers: `markers = "markers.toml"` at the top, or a table [markers] as in docs/formats.md.
"""


def start_text(
    described: OwnDescription, mesh: MeshFile, placed: PlacedMesh, file: str, unit_is_guessed: bool
) -> str:
    """Return a TOML that can be used as it is.

    Parameters
    ----------
    described : OwnDescription
        With the mesh's name as it is to be written.
    mesh : MeshFile
    placed : PlacedMesh
    file : str
        What the TOML will be called.
    unit_is_guessed : bool
    """
    return "".join(
        [
            HEAD.format(file=file, name=_text(described.name), mesh=_text(described.mesh)),
            _unit(described, mesh, unit_is_guessed),
            _material(mesh),
            MASS.format(
                centre=_numbers(_centre_in_mesh(described, mesh)),
                mass=f"{placed.mass_kg:.4g}",
                inertia=_matrix(placed.inertia_kg_m2.tolist()),
            ),
            _parts(mesh, placed),
            REST,
        ]
    )


def target_text(name: str) -> str:
    """Return a TOML for a mesh that is not there yet, for ``rvbench new target``.

    Parameters
    ----------
    name : str
    """
    return "".join(
        [
            HEAD.format(file=f"{name}.toml", name=_text(name), mesh=_text(f"{name}.glb")),
            f'unit = "m"{" " * 26}# of the mesh file: {", ".join(UNITS_M)}\n',
            f'material = "{DEFAULT_MATERIAL}"     # of parts of which neither this nor the mesh '
            "says one\n",
            MASS.format(
                centre="[0.0, 0.0, 0.0]",
                mass="500.0",
                inertia="[[300.0, 0.0, 0.0], [0.0, 250.0, 0.0], [0.0, 0.0, 400.0]]",
            ),
            "\n# A material for each part, by its name in the mesh file, or by a pattern:\n",
            f"# {', '.join(MATERIALS)}\n",
            '#[parts]\n#bus = "mli_gold"\n#"panel*" = "solar_cell"\n',
            REST,
        ]
    )


def _unit(described: OwnDescription, mesh: MeshFile, unit_is_guessed: bool) -> str:
    unit = next(name for name, value in UNITS_M.items() if value == described.unit_m)
    sides = " x ".join(f"{side:.3g}" for side in described.unit_m * size_of(mesh))
    note = f"{sides} m" + ("; our guess, for the file does not say" if unit_is_guessed else "")
    if mesh.path.suffix.lower() in IN_METRES and unit == "m":
        return f'#unit = "m"                        # by its standard: {note}\n'
    return f"unit = {_text(unit):<28} # {note}\n"


def _material(mesh: MeshFile) -> str:
    bare = [piece for piece in mesh.pieces if piece.look.red is None]
    if not bare:
        return ""
    return f'material = "{DEFAULT_MATERIAL}"           # of parts of which the mesh says nothing\n'


def _parts(mesh: MeshFile, placed: PlacedMesh) -> str:
    rows = ["\n# A material for each part, by its name or by a pattern with *; without one it is\n"]
    rows.append("# as the mesh has it. There are " + ", ".join(MATERIALS) + "\n")
    rows.append("#[parts]\n")
    said = {
        name: piece.look.said or "nothing"
        for name, piece in zip(placed.names, mesh.pieces, strict=True)
    }
    for name in [*said][:MOST_PARTS_LISTED]:
        rows.append(f'#{_text(name)} = "mli_gold"    # the mesh has: {said[name]}\n')
    if len(said) > MOST_PARTS_LISTED:
        rows.append(f"# and {len(said) - MOST_PARTS_LISTED} more\n")
    return "".join(rows)


def _centre_in_mesh(described: OwnDescription, mesh: MeshFile) -> list[float]:
    from models.spacecraft.own.skin import skin_of

    if described.centre_of_mass_in_mesh_m is not None:
        return described.centre_of_mass_in_mesh_m.tolist()
    triangles = [described.unit_m * piece.triangles for piece in mesh.pieces]
    return skin_of(np.concatenate(triangles)).centre.tolist()


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _numbers(values: Sequence[float], whole: float = 1.0) -> str:
    """Write numbers; what rounding has left of a zero, beside ``whole``, is 0."""
    shown = (0.0 if abs(value) < ROUNDING * whole else value for value in values)
    return "[" + ", ".join(f"{value:.6g}" for value in shown) + "]"


def _matrix(rows: Sequence[Sequence[float]]) -> str:
    whole = max(abs(value) for row in rows for value in row)
    return "[" + ", ".join(_numbers(row, whole) for row in rows) + "]"
