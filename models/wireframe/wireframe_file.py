"""A wireframe as JSON: what flies is a file, and may differ from what was built.

::

    {"name": "xmm",
     "landmarks": [{"name": "...", "point_in_target_m": [x, y, z], "appendage": true}, ...],
     "edges": [["name", "name"], ...],
     "triangles_in_target_m": [[[x, y, z], [x, y, z], [x, y, z]], ...],
     "symmetries": [[[...], [...], [...]], ...]}
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from models.errors import DatasetError
from models.reading.bounds import LENGTH_M
from models.reading.fields import Fields
from models.reading.json_file import read_json_table
from models.reading.shown import shown
from models.wireframe.wireframe import Wireframe

MOST_LANDMARKS = 100_000
MOST_SYMMETRIES = 1000


def wireframe_to_json(wireframe: Wireframe) -> str:
    """Return the text of a wireframe's file; numbers keep all their digits."""
    names = wireframe.landmark_names
    rows = zip(names, wireframe.points_in_target, wireframe.appendage, strict=True)
    table = {
        "name": wireframe.name,
        "landmarks": [
            {"name": name, "point_in_target_m": point.tolist(), "appendage": bool(appendage)}
            for name, point, appendage in rows
        ],
        "edges": [[names[start], names[end]] for start, end in wireframe.edges.tolist()],
        "triangles_in_target_m": wireframe.triangles_in_target.tolist(),
        "symmetries": [turn.tolist() for turn in wireframe.symmetries],
    }
    return json.dumps(table, indent=1) + "\n"


def read_wireframe(path: Path) -> Wireframe:
    """Read a wireframe's file.

    Raises
    ------
    DatasetError
        If it is missing, no JSON, lacks a key, or describes no wireframe.
    """
    try:
        return _wireframe(Fields(read_json_table(path), path))
    except (DatasetError, ValueError) as error:
        said = str(error).removeprefix(f"{path}: ")
        raise DatasetError(
            f"expected a wireframe at {path} with name, landmarks (name, point_in_target_m, "
            "appendage), edges (two names each), triangles_in_target_m and symmetries; "
            f"got: {said}"
        ) from error


def _wireframe(table: Fields) -> Wireframe:
    landmarks = table.tables("landmarks", MOST_LANDMARKS)
    names = tuple(row.text("name") for row in landmarks)
    number = {name: index for index, name in enumerate(names)}
    edges = []
    for ends in table.items("edges"):
        joined = [number.get(str(end)) for end in ends] if isinstance(ends, list) else []
        if len(joined) != 2 or None in joined:
            raise table.refusal("edges", "as two names of landmarks each", shown(ends))
        edges.append(joined)
    return Wireframe(
        name=table.text("name"),
        landmark_names=names,
        points_in_target=np.array(
            [row.vector("point_in_target_m", 3, *LENGTH_M) for row in landmarks]
        ).reshape(-1, 3),
        appendage=np.array([row.flag("appendage") for row in landmarks], dtype=np.bool_),
        edges=np.array(edges, dtype=np.int64).reshape(-1, 2),
        triangles_in_target=table.numbers("triangles_in_target_m", (None, 3, 3), *LENGTH_M),
        symmetries=tuple(table.numbers("symmetries", (None, 3, 3), -1.1, 1.1, MOST_SYMMETRIES)),
    )
