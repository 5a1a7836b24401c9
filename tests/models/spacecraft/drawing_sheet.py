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
from collections.abc import Callable
from pathlib import Path

import numpy as np

from models.arm.house_arm import house_arm
from models.arm.shape import arm_parts
from models.arrays import Floats
from models.spacecraft import hispasat_layout, xmm
from models.spacecraft.anti_earth_deck import anti_earth_deck_parts
from models.spacecraft.apogee_engine import apogee_engine_parts
from models.spacecraft.bus import bus_parts
from models.spacecraft.chaser import chaser
from models.spacecraft.earth_deck import earth_deck_parts
from models.spacecraft.grasp_markers import BOARD, _board
from models.spacecraft.hispasat_antennas import antenna_parts
from models.spacecraft.hispasat_body import body_parts
from models.spacecraft.launch_adaptor_ring import launch_adaptor_ring_parts
from models.spacecraft.marker_support import marker_support_parts
from models.spacecraft.offset_reflector import offset_reflector_parts
from models.spacecraft.part import Part
from models.spacecraft.radiator import radiator_parts
from models.spacecraft.retroreflector_layout import RETROREFLECTORS
from models.spacecraft.solar_wing import solar_wing_parts
from models.spacecraft.thruster import thruster_parts
from models.spacecraft.wireframes import WIREFRAMES, wireframe_by_name
from models.spacecraft.xmm_service_module import service_module_parts
from models.spacecraft.xmm_telescope import telescope_parts

SHEET = Path(__file__).with_name("drawing_sheet.csv")
HULLS = "hulls"


def _both(builder: Callable[[float], tuple[Part, ...]]) -> Callable[[], tuple[Part, ...]]:
    return lambda: (*builder(1.0), *builder(-1.0))


ASSEMBLIES: dict[str, Callable[[], tuple[Part, ...]]] = {
    "bus": bus_parts,
    "launch_adaptor_ring": launch_adaptor_ring_parts,
    "apogee_engine": apogee_engine_parts,
    "marker_supports": lambda: marker_support_parts(RETROREFLECTORS),
    "thrusters": thruster_parts,
    "anti_earth_deck": anti_earth_deck_parts,
    "radiators": _both(radiator_parts),
    "maxar_wings": _both(solar_wing_parts),
    "reflectors": _both(offset_reflector_parts),
    "earth_deck": earth_deck_parts,
    "grasp_board": lambda: (Part(BOARD, _board(), "marker_black"),),
    "xmm_service_module": service_module_parts,
    "xmm_telescope": telescope_parts,
    "xmm_wings": _both(xmm._wing),
    "hispasat_body": body_parts,
    "hispasat_antennas": antenna_parts,
    "hispasat_wings": _both(
        lambda sign: hispasat_layout.WING.parts(
            "plus_y" if sign > 0.0 else "minus_y", hispasat_layout.body_from_wing(sign)
        )
    ),
    "chaser": lambda: chaser().parts,
    "arm": lambda: arm_parts(house_arm()),
}
"""What is drawn on one sheet: the parts that one function returns."""
DRAWN = (*ASSEMBLIES, HULLS)
COUNTS = ("vertices", "triangles")
SIZES = (
    "area_m2", "volume_m3", "low_x", "low_y", "low_z", "high_x", "high_y", "high_z",
    "centroid_x", "centroid_y", "centroid_z", "gyration_x", "gyration_y", "gyration_z",
)  # fmt: skip
COLUMNS = ("assembly", "part", "material", "smooth", "frame", *COUNTS, *SIZES)


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


def rows_of(assembly: str) -> list[dict[str, str]]:
    """Measure an assembly, as the sheet has it; hulls are what wireframes hide things by."""
    rows: list[list[object]] = []
    if assembly == HULLS:
        for name in sorted(WIREFRAMES):
            hull = wireframe_by_name(name).triangles_in_target
            rows.append([assembly, name, "", "", "", "", len(hull), *measured(hull)])
    else:
        for part in ASSEMBLIES[assembly]():
            triangles = np.asarray(part.mesh.triangles, dtype=np.float64)
            counts = len(part.mesh.vertices), len(triangles)
            told = part.name, part.material, part.smooth, part.frame
            rows.append([assembly, *told, *counts, *measured(triangles)])
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
        for assembly in DRAWN:
            writer.writerows(rows_of(assembly))


if __name__ == "__main__":
    sys.exit(main())
