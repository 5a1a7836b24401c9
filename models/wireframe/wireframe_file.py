"""A wireframe as JSON: what flies is a file, and may differ from what was built.

::

    {"name": "xmm",
     "landmarks": [{"name": "...", "point_in_target_m": [x, y, z], "appendage": true}, ...],
     "edges": [["name", "name"], ...],
     "triangles_in_target_m": [[[x, y, z], [x, y, z], [x, y, z]], ...],
     "symmetries": [[[...], [...], [...]], ...],
     "finishes": [[[diffuse, mirror, roughness, glass], [...]], ...]}

Finishes are of the triangles' two sides, and may be left out; see ``models.wireframe.finish``.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from models.arrays import Indices
from models.errors import DatasetError, cause
from models.reading.bounds import LENGTH_M
from models.reading.fields import Fields
from models.reading.json_file import read_json_table
from models.reading.shown import shown
from models.reading.uncertainty import exact_rotation
from models.wireframe.finish import Finish
from models.wireframe.wireframe import Wireframe

MOST_BYTES = 256_000_000
MOST_LANDMARKS, MOST_EDGES = 100_000, 1_000_000
MOST_TRIANGLES, MOST_SYMMETRIES = 1_000_000, 1000


def wireframe_to_json(wireframe: Wireframe) -> str:
    """Return the text of a wireframe's file; numbers keep all their digits."""
    names = wireframe.landmark_names
    rows = zip(names, wireframe.points_in_target, wireframe.appendage, strict=True)
    table: dict[str, Any] = {
        "name": wireframe.name,
        "landmarks": [
            {"name": name, "point_in_target_m": point.tolist(), "appendage": bool(appendage)}
            for name, point, appendage in rows
        ],
        "edges": [[names[start], names[end]] for start, end in wireframe.edges.tolist()],
        "triangles_in_target_m": wireframe.triangles_in_target.tolist(),
        "symmetries": [turn.tolist() for turn in wireframe.symmetries],
    }
    if wireframe.finish is not None:
        table["finishes"] = wireframe.finish.table.tolist()
    return json.dumps(table, indent=1) + "\n"


def read_wireframe(path: Path) -> Wireframe:
    """Read a wireframe's file.

    Raises
    ------
    DatasetError
        If it is missing, no JSON, lacks a key, or describes no wireframe.
    """
    try:
        return _wireframe(Fields(read_json_table(path, MOST_BYTES), path))
    except (DatasetError, ValueError) as error:
        raise DatasetError(
            f"expected a wireframe at {path} with name, landmarks (name, point_in_target_m, "
            "appendage), edges (two names each), triangles_in_target_m and symmetries; "
            f"got: {cause(error)}"
        ) from error


def _wireframe(fields: Fields) -> Wireframe:
    required = ("name", "landmarks", "edges", "triangles_in_target_m", "symmetries")
    fields.only(required, ("finishes",))
    landmarks = fields.tables("landmarks", MOST_LANDMARKS)
    for row in landmarks:
        row.only(("name", "point_in_target_m", "appendage"))
    names = tuple(row.text("name") for row in landmarks)
    points = [row.vector("point_in_target_m", 3, *LENGTH_M) for row in landmarks]
    turns = fields.numbers("symmetries", (None, 3, 3), -2.0, 2.0, MOST_SYMMETRIES)
    return Wireframe(
        name=fields.text("name"),
        landmark_names=names,
        points_in_target=np.array(points, dtype=np.float64).reshape(-1, 3),
        appendage=np.array([row.flag("appendage") for row in landmarks], dtype=np.bool_),
        edges=_edges(fields, names),
        triangles_in_target=fields.numbers(
            "triangles_in_target_m", (None, 3, 3), *LENGTH_M, MOST_TRIANGLES
        ),
        symmetries=tuple(exact_rotation(turn) for turn in turns),
        finish=_finish(fields),
    )


def _finish(fields: Fields) -> Finish | None:
    if "finishes" not in fields:
        return None
    return Finish.of(fields.numbers("finishes", (None, 2, 4), 0.0, 1.0, MOST_TRIANGLES))


def _edges(fields: Fields, names: tuple[str, ...]) -> Indices:
    number = {name: index for index, name in enumerate(names)}
    edges = []
    for ends in fields.items("edges", MOST_EDGES):
        if not isinstance(ends, list) or len(ends) != 2:
            raise fields.refusal("edges", "as pairs of landmarks' names", shown(ends))
        for end in ends:
            if not isinstance(end, str) or end not in number:
                raise fields.refusal("edges", "between landmarks by their names", shown(end))
        edges.append([number[end] for end in ends])
    return np.array(edges, dtype=np.int64).reshape(-1, 2)
