"""Make the meshes that reports show of our own targets: few triangles, committed as GLB.

``python -m bench.report.explorer.build_meshes``: minutes, so no report does it. A target's parts
are thinned one by one, each to its share of the triangles by the root of its area, and joined by
their shade.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bench.report.explorer.glb import Surface, glb_bytes
from models.arrays import Floats
from models.atomic_file import write_bytes
from models.plain_console import plain_console
from models.spacecraft.catalogue import TARGETS, spacecraft_by_name
from models.spacecraft.own.simplify import simplified
from models.spacecraft.own.welded import welded
from models.spacecraft.part import Spacecraft

FOLDER = Path(__file__).parent / "meshes"
MOST_FACES = 9_000
LEAST_OF_A_PART = 24
SHADES = 6  # of grey


def display_mesh(craft: Spacecraft, most: int = MOST_FACES) -> bytes:
    """Return a spacecraft in about so many triangles, as GLB.

    Parameters
    ----------
    craft : Spacecraft
    most : int
    """
    weights = np.sqrt([float(part.mesh.area) for part in craft.parts])
    shares = most * weights / weights.sum()
    by_shade: dict[float, list[Floats]] = {}
    for part, share in zip(craft.parts, shares, strict=True):
        material = craft.material_of(part)
        bright = material.diffuse.sunlight + material.specular.sunlight
        shade = round(np.ceil(SHADES * min(bright, 1.0)) / SHADES, 3)
        triangles = np.asarray(part.mesh.vertices, dtype=np.float64)[part.mesh.faces]
        thin = simplified(triangles, max(LEAST_OF_A_PART, round(share)))
        by_shade.setdefault(shade, []).append(thin)
    surfaces = []
    for shade, pieces in sorted(by_shade.items()):
        body = welded(np.concatenate(pieces))
        surfaces.append(Surface(f"shade_{shade:g}", body.points, body.faces, (shade, shade, shade)))
    return glb_bytes(surfaces)


def main() -> None:
    """Write all of them anew."""
    for name in TARGETS:
        path = FOLDER / f"{name}.glb"
        write_bytes(path, display_mesh(spacecraft_by_name(name)))
        plain_console().print(f"wrote {path.name}, {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
