"""What the parts of our spacecraft measure, from their triangles; writes ``drawing_sheet.csv``.

    python -m tests.models.spacecraft.drawing_sheet

Few sizes of a spacecraft are published, and those have tests of their own. All others are ours, and
yet no figure of the README or of a suite holds for another shape: markers are hidden, corners found
and centres of mass judged on just these surfaces. So the sheet is a drawing under control of its
issue: who redraws a part measures it anew, and the difference shows which part that was and by how
much. Areas and moments are integrals over the triangles; no number of the code is repeated.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from models.arm.house_arm import house_arm
from models.arm.shape import arm_parts
from models.arrays import Floats
from models.spacecraft.catalogue import spacecraft_by_name
from models.spacecraft.grasp_markers import BOARD
from models.spacecraft.part import Part
from models.spacecraft.wireframes import WIREFRAMES, wireframe_by_name

SHEET = Path(__file__).with_name("drawing_sheet.csv")
CRAFTS = ("maxar1300", "xmm", "hispasat", "chaser", "board", "arm", "hulls")
COUNTS = ("vertices", "triangles")
SIZES = (
    "area_m2", "volume_m3", "low_x", "low_y", "low_z", "high_x", "high_y", "high_z",
    "centroid_x", "centroid_y", "centroid_z", "gyration_x", "gyration_y", "gyration_z",
)  # fmt: skip
COLUMNS = ("craft", "part", "material", "smooth", "frame", *COUNTS, *SIZES)


def measured(triangles: Floats) -> list[float]:
    """Return the sizes of a surface, in the order of ``SIZES``.

    Area; volume enclosed, of an open sheet that of the cone from the origin; bounds; centroid and
    radii of gyration of the surface.

    Parameters
    ----------
    triangles : (n, 3, 3) array, m
    """
    a, b, c = triangles.transpose(1, 0, 2)
    normal = 0.5 * np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1)
    centroid = area @ triangles.mean(axis=1) / area.sum()
    # The middles of the edges integrate a quadratic over a triangle exactly.
    middles = 0.5 * (triangles + np.roll(triangles, 1, axis=1)) - centroid
    spread = np.sqrt(area @ (middles**2).mean(axis=1) / area.sum())
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    volume = float(np.einsum("ij,ij->", a, normal)) / 3.0
    return [float(area.sum()), volume, *low, *high, *centroid, *spread]


def parts_of(craft: str) -> Iterator[tuple[Part, Floats]]:
    """Yield a craft's parts, each with its triangles, (n, 3, 3) m."""
    if craft == "arm":
        parts = arm_parts(house_arm())
    elif craft == "board":
        parts = tuple(p for p in spacecraft_by_name("maxar1300_grasp").parts if p.name == BOARD)
    else:
        parts = spacecraft_by_name(craft).parts
    for part in parts:
        yield part, np.asarray(part.mesh.triangles, dtype=np.float64)


def rows_of(craft: str) -> list[dict[str, str]]:
    """Measure a craft, as the sheet has it; ``hulls`` are what wireframes hide things by."""
    if craft == "hulls":
        rows = []
        for name in sorted(WIREFRAMES):
            hull = wireframe_by_name(name).triangles_in_target
            rows.append([craft, name, "", "", "", "", len(hull), *measured(hull)])
    else:
        rows = [
            [
                craft, part.name, part.material, part.smooth, part.frame,
                len(part.mesh.vertices), len(triangles), *measured(triangles),
            ]
            for part, triangles in parts_of(craft)
        ]  # fmt: skip
    return [
        {
            column: f"{value:.7f}" if isinstance(value, float) else str(value)
            for column, value in zip(COLUMNS, row, strict=True)
        }
        for row in rows
    ]


def main() -> None:
    """Write the sheet."""
    with SHEET.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for craft in CRAFTS:
            writer.writerows(rows_of(craft))


if __name__ == "__main__":
    sys.exit(main())
