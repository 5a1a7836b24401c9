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
from typing import Any

import numpy as np

from models.errors import DatasetError, cause
from models.wireframe.wireframe import Wireframe


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
        return _wireframe(json.loads(path.read_text()))
    except (OSError, UnicodeDecodeError, KeyError, TypeError, ValueError) as error:
        raise DatasetError(
            f"expected a wireframe at {path} with name, landmarks (name, point_in_target_m, "
            "appendage), edges (two names each), triangles_in_target_m and symmetries; "
            f"got: {cause(error)}"
        ) from error


def _wireframe(table: dict[str, Any]) -> Wireframe:
    landmarks = table["landmarks"]
    names = tuple(str(row["name"]) for row in landmarks)
    number = {name: index for index, name in enumerate(names)}
    edges = [[number[start], number[end]] for start, end in table["edges"]]
    return Wireframe(
        name=str(table["name"]),
        landmark_names=names,
        points_in_target=np.array(
            [row["point_in_target_m"] for row in landmarks], dtype=np.float64
        ).reshape(-1, 3),
        appendage=np.array([bool(row["appendage"]) for row in landmarks], dtype=np.bool_),
        edges=np.array(edges, dtype=np.int64).reshape(-1, 2),
        triangles_in_target=np.array(table["triangles_in_target_m"], dtype=np.float64).reshape(
            -1, 3, 3
        ),
        symmetries=tuple(np.array(turn, dtype=np.float64) for turn in table["symmetries"]),
    )
