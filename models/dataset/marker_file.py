"""``markers.toml``: a target's markers as surveyed, or a user's own as installed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from models.arrays import Floats
from models.errors import DatasetError
from models.markers import CornerCubes, MarkerPattern
from models.reading.bounds import LENGTH_M
from models.reading.fields import Fields
from models.reading.toml_file import read_toml

MOST_MARKERS = 1000
LEAST_MARKERS = 3  # six unknowns, two numbers a marker
LARGEST_RADIUS_M = 10.0
PAINT_OF_KIND = {"retroreflector": "", "white_dot": "white_paint"}


def markers_to_toml(markers: MarkerPattern) -> str:
    """Return the text of ``markers.toml``."""
    rows = zip(
        markers.names,
        markers.points_in_target.tolist(),
        markers.normals_in_target.tolist(),
        strict=True,
    )
    kind = {"kind": "white_dot"} if markers.paint else {}
    table: dict[str, Any] = {
        "radius_m": float(markers.radius_m),
        "marker": [
            {"name": name, "point_in_target_m": point, "normal_in_target": normal, **kind}
            for name, point, normal in rows
        ],
    }
    if (cubes := markers.cubes) is not None:
        table["cubes"] = {
            "refractive_index": float(cubes.refractive_index),
            "edge_share": float(cubes.edge_share),
        }
        if cubes.edges_in_target is not None:
            for row, edge in zip(table["marker"], cubes.edges_in_target.tolist(), strict=True):
                row["edge_in_target"] = edge
    return tomli_w.dumps(table)


def read_markers(path: Path) -> MarkerPattern:
    """Read ``markers.toml``.

    Raises
    ------
    DatasetError
        If a key is missing, a value cannot be, or no pose could ever be found from the markers:
        fewer than three, two in one place, or all on one line.
    """
    return markers_of(Fields(read_toml(path), path))


def markers_of(fields: Fields) -> MarkerPattern:
    """Return the markers of a table that was read, from wherever.

    Raises
    ------
    DatasetError
        As ``read_markers``.
    """
    fields.only(("radius_m", "marker"), ("cubes",))
    rows = fields.tables("marker", MOST_MARKERS)
    kinds: set[str] = set()
    for row in rows:
        row.only(("name", "point_in_target_m", "normal_in_target"), ("kind", "edge_in_target"))
        kind = row.text("kind") if "kind" in row else "retroreflector"
        if kind not in PAINT_OF_KIND:
            raise row.refusal("kind", f"as one of {', '.join(PAINT_OF_KIND)}", kind)
        kinds.add(kind)
    if len(kinds) > 1:
        raise fields.refusal("marker", "of one kind", " and ".join(sorted(kinds)))
    radius_m = fields.number("radius_m", 0.0, LARGEST_RADIUS_M, above=0.0)
    points = np.array([row.vector("point_in_target_m", 3, *LENGTH_M) for row in rows])
    normals = np.array([row.vector("normal_in_target", 3, -2.0, 2.0) for row in rows])
    try:
        markers = MarkerPattern(
            names=tuple(row.text("name") for row in rows),
            points_in_target=points.reshape(-1, 3),
            normals_in_target=normals.reshape(-1, 3),
            radius_m=radius_m,
            paint=PAINT_OF_KIND[kinds.pop()] if kinds else "",
            cubes=_cubes_of(fields, rows),
        )
    except ValueError as error:
        raise DatasetError(f"{fields.where}: {error}") from error
    if useless := _useless(markers):
        raise DatasetError(
            f"{fields.where}: expected markers from which a pose can be found, at least "
            f"{LEAST_MARKERS}, apart and not on one line; {useless}"
        )
    return markers


def _cubes_of(fields: Fields, rows: Sequence[Fields]) -> CornerCubes | None:
    """Return what is said of the markers' cubes; None where nothing is.

    Raises
    ------
    DatasetError
        If only some edges are told, or edges of no cubes.
    ValueError
        If a value cannot be.
    """
    told = ["edge_in_target" in row for row in rows]
    if any(told) and not all(told):
        raise rows[told.index(False)].refusal("edge_in_target", "for every marker or none", None)
    if "cubes" not in fields:
        if any(told):
            raise fields.refusal("cubes", "where markers have an edge_in_target", None)
        return None
    cubes = fields.table("cubes")
    cubes.only(("refractive_index", "edge_share"))
    edges = np.array([row.vector("edge_in_target", 3, -2.0, 2.0) for row in rows if any(told)])
    return CornerCubes(
        refractive_index=cubes.number("refractive_index", 1.0, 5.0, above=1.0),
        edge_share=cubes.number("edge_share", 0.0, 0.5),
        edges_in_target=edges if any(told) else None,
    )


def _useless(markers: MarkerPattern) -> str:
    """Say why no pose follows from the markers; nothing if one may."""
    if len(markers) < LEAST_MARKERS:
        return f"got {len(markers)}"
    points: Floats = markers.points_in_target
    if markers.min_separation_m < markers.radius_m:
        return f"two are {markers.min_separation_m:.3g} m apart, less than their radius"
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if spread[1] < markers.radius_m:
        return f"all lie within {spread[1]:.3g} m of one line"
    return ""
