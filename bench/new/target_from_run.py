"""A spacecraft's TOML and mesh from what a run of an unknown target carved.

The chain that an inspection would fly: what was found by silhouettes becomes the model by which the
target is tracked from then on. Marching cubes leave many small faces and no edge; collapsed to few,
where the surface moves least, flat sides become flat and what stands between them an edge.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import trimesh

from bench.estimating.runs import spoken_variants
from bench.estimating.unknown.shape_files import SHAPE_JSON, read_surface, shape_folder
from models.arrays import Floats
from models.dataset.dataset import open_dataset
from models.errors import ScenarioError
from models.reading.json_file import read_json_table
from models.spacecraft.own.simplify import simplified

FACES = 400
TEXT = """\
# A spacecraft that a run carved: {run}, images up to frame {frame}, {silhouettes} silhouettes.
# Its axes are those of the run's estimates, its origin the centre of mass. What no outline
# shows, such as a hollow, is not in it. docs/formats.md tells of every key.

name = {name}
mesh = {mesh}
origin = "mesh"
centre_of_mass_in_mesh_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = {inertia}   # trace 1: of a free body only ratios matter
material = "white_paint"

[wireframe]
sharp_deg = 25.0                    # faces that meet at more make an edge
symmetries = false
"""


def target_from_run(name: str, run: Path) -> dict[str, str | bytes]:
    """Return the files of a spacecraft that a run carved, by name.

    Parameters
    ----------
    name : str
        The files will be NAME.toml and NAME.glb.
    run : Path
        A dataset of an unknown target, estimated.

    Raises
    ------
    DatasetError
        If it is no dataset, or a file of it cannot be read.
    ScenarioError
        If it has no surface.
    """
    dataset = open_dataset(run)
    for label in spoken_variants(run):
        triangles = read_surface(dataset, label)
        if triangles is not None:
            break
    else:
        raise ScenarioError(
            f"{run}: expected the surface of an unknown target in estimates/shape, got "
            f"{_why_none(run)}; `rvbench estimate {run}` carves one once the target has turned"
        )
    told = read_json_table(shape_folder(run, label) / SHAPE_JSON)
    text = TEXT.format(
        run=run.resolve().name,
        frame=told["frame"],
        silhouettes=told["silhouettes"],
        name=json.dumps(name, ensure_ascii=False),
        mesh=json.dumps(f"{name}.glb", ensure_ascii=False),
        inertia=json.dumps(told["inertia_of_trace_1"]),
    )
    return {f"{name}.glb": faceted_glb(triangles), f"{name}.toml": text}


def faceted_glb(triangles: Floats, faces: int = FACES) -> bytes:
    """Return a surface of few faces as GLB.

    Parameters
    ----------
    triangles : (f, 3, 3) array, m
    faces : int
        About so many are left.
    """
    few = simplified(triangles, faces)
    points, corners = np.unique(few.reshape(-1, 3), axis=0, return_inverse=True)
    mesh = trimesh.Trimesh(points, np.asarray(corners).reshape(-1, 3), process=False)
    data = mesh.export(file_type="glb")
    assert isinstance(data, bytes)
    return data


def _why_none(run: Path) -> str:
    reasons = [
        str(read_json_table(path).get("no_surface") or "one of other estimates")
        for path in sorted((run / "estimates" / "shape").glob(f"*/{SHAPE_JSON}"))
    ]
    return "; ".join(reasons) or "none"
