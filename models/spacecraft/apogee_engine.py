"""The apogee engine in the middle of the ring, and the heat shield round it.

A 490 N bipropellant engine of the R-4D class: chamber and throat sunk in a well of the bus, a
bell of large area ratio that ends just below the ring plane.
"""

from __future__ import annotations

import numpy as np
import trimesh

from models.arrays import Floats
from models.spacecraft.bus import ENGINE_WELL_M, FACE_Z_M
from models.spacecraft.launch_adaptor_ring import FOOT_INNER_M
from models.spacecraft.mli_blanket import Blanket
from models.spacecraft.part import Part
from models.spacecraft.solids import cup, joined, lathe, shifted

EXIT_Z_M = -0.025
EXIT_RADIUS_M = 0.165
THROAT_Z_M = -0.50
THROAT_RADIUS_M = 0.0105
CHAMBER_RADIUS_M = 0.027
CHAMBER_LENGTH_M = 0.10
WALL_M = 0.0025
WELL_DEPTH_M = 0.62
SEGMENTS = 80


def apogee_engine_parts() -> tuple[Part, ...]:
    """Return the engine, its heat shield and the well's lining."""
    return (
        Part("apogee_engine", _engine(), "titanium_nozzle", smooth=True),
        Part("apogee_engine", _stiffeners(), "titanium_nozzle", smooth=True),
        Part("heat_shield", _heat_shield(), "mli_aluminium", smooth=True),
        Part("heat_shield", _well(), "mli_aluminium", smooth=True),
        Part("heat_shield", _shield_rim(), "bare_aluminium", smooth=True),
    )


def bell_contour() -> Floats:
    """Return the bell's inner contour from throat to exit, (n, 2) m as (radius, z).

    A parabola in z(r), steep at the throat and 9 degrees from the axis at the lip, as bells are
    (Rao 1958, the parabolic approximation).
    """
    start, end = np.deg2rad([35.0, 9.0])
    r0, z0, r2, z2 = THROAT_RADIUS_M, THROAT_Z_M, EXIT_RADIUS_M, EXIT_Z_M
    # The control point of the quadratic Bezier curve: where both tangents meet.
    z1 = (r2 - r0 + z0 * np.tan(start) - z2 * np.tan(end)) / (np.tan(start) - np.tan(end))
    r1 = r0 + (z1 - z0) * np.tan(start)
    t = np.linspace(0.0, 1.0, 25)[:, None]
    points = (1 - t) ** 2 * [r0, z0] + 2 * t * (1 - t) * [r1, z1] + t**2 * [r2, z2]
    return np.asarray(points)


def _engine() -> trimesh.Trimesh:
    """Turn the whole engine: outside up from the injector, over the lip, inside down again."""
    bell = bell_contour()
    neck = THROAT_Z_M - 0.02
    head = neck - CHAMBER_LENGTH_M
    outside = [
        (0.0, head - 0.02),
        (CHAMBER_RADIUS_M + 0.012, head - 0.02),
        (CHAMBER_RADIUS_M + 0.012, head),
        (CHAMBER_RADIUS_M + 0.004, head),
        (CHAMBER_RADIUS_M + 0.004, neck),
        *(bell + np.array([WALL_M, 0.0])).tolist(),
    ]
    inside = [*bell[::-1].tolist(), (CHAMBER_RADIUS_M, neck), (CHAMBER_RADIUS_M, head), (0.0, head)]
    return lathe(outside + inside, SEGMENTS)


def _stiffeners() -> trimesh.Trimesh:
    """Return the rings that stiffen the bell: two on the way and one under the lip."""
    bell = bell_contour()
    rings = []
    for index in (12, 19, 24):
        radius, z = bell[index] + np.array([WALL_M, 0.0])
        rings.append(
            lathe(
                [
                    (radius - WALL_M, z - 0.008),
                    (radius + 0.003, z - 0.008),
                    (radius + 0.003, z - 0.002),
                    (radius - WALL_M, z - 0.002),
                    (radius - WALL_M, z - 0.008),
                ],
                SEGMENTS,
            )
        )
    return joined(rings)


def _shield_blanket() -> Blanket:
    angles = np.deg2rad(np.arange(15.0, 375.0, 60.0))
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    seams = tuple(
        ((0.24 * float(x), 0.24 * float(y)), (0.76 * float(x), 0.76 * float(y))) for x, y in rays
    )
    return Blanket(
        low=(-FOOT_INNER_M, -FOOT_INNER_M),
        high=(FOOT_INNER_M, FOOT_INNER_M),
        facet_m=0.018,
        seed=490,
        seams=seams,
        hole=(0.0, 0.0, ENGINE_WELL_M),
        is_round=True,
    )


def _heat_shield() -> trimesh.Trimesh:
    blanket = _shield_blanket()
    return shifted(joined([blanket.foil(), blanket.tape()]), (0.0, 0.0, FACE_Z_M))


def _well() -> trimesh.Trimesh:
    bottom = FACE_Z_M - WELL_DEPTH_M
    return cup(ENGINE_WELL_M, ENGINE_WELL_M, bottom, FACE_Z_M - 0.001, 0.004, 48)


def _shield_rim() -> trimesh.Trimesh:
    """Return the ring that clamps the heat shield round the well."""
    inner, outer = ENGINE_WELL_M - 0.006, ENGINE_WELL_M + 0.016
    bottom, top = FACE_Z_M - 0.002, FACE_Z_M + 0.006
    return lathe(
        [(inner, bottom), (outer, bottom), (outer, top), (inner, top), (inner, bottom)], SEGMENTS
    )
