"""The targets' shapes, as BOP has them: PLY with normals, in mm, whole and coarse, and their sizes.

The coarse one merges the corners of each cell of a grid (Rossignac and Borrel 1993) and drops what
that flattens: no corner moves by more than the cell's diagonal.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import trimesh
from scipy.spatial import ConvexHull
from scipy.spatial.distance import pdist

from bench.export.formats.format import Streamed
from bench.export.json_stream import whole
from bench.export.plan import Plan
from bench.export.source import TargetModel
from models.arrays import Floats, Indices

MM = 1e3
CELLS = 300.0  # across the diameter: a tenth of a metre of thirty
ROWS = 20_000  # lines written at once
MOST_HULL = 4000  # corners of a hull, of which all pairs are tried


def model_files(plan: Plan) -> Streamed:
    """Return ``models`` and ``models_eval`` of all targets whose shape is known.

    Parameters
    ----------
    plan : Plan
    """
    told: dict[str, dict[str, dict[str, Any]]] = {"models": {}, "models_eval": {}}
    for number, source in plan.targets():
        if source.target is None:
            continue
        target = source.target
        for folder, (vertices, faces) in {
            "models": (target.vertices, target.faces),
            "models_eval": coarse(target.vertices, target.faces, diameter_m(target.vertices)),
        }.items():
            told[folder][str(number)] = model_info(target, vertices)
            yield f"{folder}/obj_{number:06d}.ply", ply(vertices, faces)
    for folder, infos in told.items():
        yield f"{folder}/models_info.json", whole(infos)


def model_info(target: TargetModel, vertices: Floats) -> dict[str, Any]:
    """Return a model's entry in ``models_info.json``: lengths in mm.

    Parameters
    ----------
    target : TargetModel
    vertices : (v, 3) array, m
    """
    low, high = MM * vertices.min(axis=0), MM * vertices.max(axis=0)
    info: dict[str, Any] = {"diameter": MM * diameter_m(vertices)}
    info |= {f"min_{axis}": float(x) for axis, x in zip("xyz", low, strict=True)}
    info |= {f"size_{axis}": float(x) for axis, x in zip("xyz", high - low, strict=True)}
    turns = () if target.wireframe is None else target.wireframe.symmetries
    if turns:
        info["symmetries_discrete"] = [_matrix(turn) for turn in turns]
    return info


def diameter_m(vertices: Floats) -> float:
    """Return the largest distance between any two of (v, 3) points, m."""
    hull = vertices[ConvexHull(vertices, qhull_options="QJ").vertices]
    if len(hull) <= MOST_HULL:
        return float(pdist(hull).max())
    return max(float(np.linalg.norm(hull - point, axis=1).max()) for point in hull)


def coarse(vertices: Floats, faces: Indices, across_m: float) -> tuple[Floats, Indices]:
    """Return a mesh with a corner a cell.

    Parameters
    ----------
    vertices : (v, 3) array, m
    faces : (f, 3) array of int
    across_m : float, m
        Of which a cell's edge is the 300th part.

    Returns
    -------
    (w, 3) array, (g, 3) array
        Corners that faces use, and faces, none twice and none without area.
    """
    cells = np.floor(vertices / (across_m / CELLS)).astype(np.int64)
    _, of_cell = np.unique(cells, axis=0, return_inverse=True)
    of_cell = of_cell.ravel()
    counts = np.bincount(of_cell)
    merged = np.stack([np.bincount(of_cell, vertices[:, k]) / counts for k in range(3)], axis=1)
    kept = of_cell[faces]
    kept = kept[
        (kept[:, 0] != kept[:, 1]) & (kept[:, 1] != kept[:, 2]) & (kept[:, 2] != kept[:, 0])
    ]
    _, first = np.unique(np.sort(kept, axis=1), axis=0, return_index=True)
    kept = kept[np.sort(first)]
    used, faces = np.unique(kept, return_inverse=True)
    return merged[used], np.asarray(faces.reshape(-1, 3), dtype=np.int64)


def ply(vertices: Floats, faces: Indices) -> Iterator[bytes]:
    """Return an ASCII PLY in mm with normals, piece by piece.

    Parameters
    ----------
    vertices : (v, 3) array, m
    faces : (f, 3) array of int
    """
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    normals = np.asarray(mesh.vertex_normals)
    coordinates = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    yield (
        f"ply\nformat ascii 1.0\ncomment lengths in mm\nelement vertex {len(vertices)}\n"
        f"{coordinates}element face {len(faces)}\n"
        "property list uchar int vertex_indices\nend_header\n"
    ).encode()
    rows = np.hstack([MM * vertices, normals])
    for start in range(0, len(rows), ROWS):
        yield "".join(
            "{:.4f} {:.4f} {:.4f} {:.5f} {:.5f} {:.5f}\n".format(*row)
            for row in rows[start : start + ROWS].tolist()
        ).encode()
    for start in range(0, len(faces), ROWS):
        yield "".join(
            "3 {} {} {}\n".format(*row) for row in faces[start : start + ROWS].tolist()
        ).encode()


def _matrix(turn: Floats) -> list[float]:
    """Return a turn about the origin as 16 numbers, row by row."""
    matrix = np.eye(4)
    matrix[:3, :3] = turn
    return [float(x) for x in matrix.ravel()]
