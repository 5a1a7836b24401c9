"""Corners that grain makes: those of a frame that the same frame by other light does not repeat.

A corner of the scene is there whatever the light's seed; one that the next seed has nowhere near is
the Monte-Carlo noise's, or the detector's. How many the detector alone makes is told beside: two
exposures of one light.
"""

from __future__ import annotations

import argparse
import sys

import numpy as np
from rich.table import Table

from bench.grain.light import exposure_s, traced
from bench.grain.rows import TABLE, Place, Row
from bench.grain.table import FRAME_SEED, WAYS
from models.arrays import Floats
from models.plain_console import plain_console
from pipelines.detection.corners import find_corners
from renders.detector.expose import expose_electrons, mean_electrons

NEAR_PX = 1.5  # a corner this near to one of the other frame is the same
COLUMNS = ("frame", "way", "corners", "not repeated", "by the detector alone")


def unrepeated(points_px: Floats, other_px: Floats) -> int:
    """Count the points that have none of the others near them.

    Parameters
    ----------
    points_px, other_px : (n, 2) and (m, 2) arrays, px
    """
    if not len(points_px) or not len(other_px):
        return len(points_px)
    apart = np.linalg.norm(points_px[:, None] - other_px[None], axis=2)
    return int((apart.min(axis=1) > NEAR_PX).sum())


def corners_of_light(row: Row, render: dict[str, object], seed: int) -> list[Floats]:
    """Trace a frame once, expose it twice, and return the corners of both images.

    Parameters
    ----------
    row : Row
    render : dict
        Keys of ``[render]`` that differ from the case's.
    seed : int
        Of the light.

    Returns
    -------
    list of (n, 2) arrays, px
    """
    place = Place.of(row, {**render, "seed": seed})
    scenario = place.world.scenario
    detector = scenario.simulated_detector
    span_s = exposure_s(place)
    mean_e = mean_electrons(
        (traced(place).electrons / span_s).astype(np.float32),
        1e3 * span_s,
        place.world.camera,
        scenario.simulated_optics,
        detector,
    )
    images = [
        expose_electrons(mean_e, detector, np.random.default_rng([seed, draw])) for draw in (0, 1)
    ]
    return [find_corners(image, detector).points_px for image in images]


def main() -> int:
    """Print the table."""
    from renders.batches.studio import start_renderer
    from renders.variant.choice import choose_variant

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", nargs="*", help="names of rows")
    parser.add_argument("--ways", nargs="*", choices=list(WAYS), default=["the case", "noise 0.5"])
    asked = parser.parse_args()
    console = plain_console()
    start_renderer(choose_variant("auto"), None)
    table = Table(*COLUMNS)
    for row in TABLE:
        if asked.rows is not None and row.name not in asked.rows:
            continue
        for way in asked.ways:
            first = corners_of_light(row, WAYS[way], FRAME_SEED)
            other = corners_of_light(row, WAYS[way], FRAME_SEED + 1)
            table.add_row(
                row.name,
                way,
                str(len(first[0])),
                str(unrepeated(first[0], other[0])),
                str(unrepeated(first[0], first[1])),
            )
    console.print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
