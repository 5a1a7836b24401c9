"""The fittings round the ring, on +z: sensors, handles, harness, service panels.

Tall ones stand on the +y half; the -y half is left to the markers, and whatever stands there
stays well below their faces (z = 0).
"""

from __future__ import annotations

import numpy as np
import trimesh

from models.arrays import Floats
from models.spacecraft.bus import FACE_Z_M
from models.spacecraft.part import Part
from models.spacecraft.solids import (
    bar,
    box,
    cup,
    cylinder,
    hexagon,
    joined,
    lathe,
    placed,
    prism,
    shifted,
    standing,
    tube,
)

STAR_TRACKERS = (((-0.46, 1.02), (-0.35, 0.45, 1.0)), ((0.46, 1.02), (0.35, 0.45, 1.0)))
SUN_SENSORS = ((-1.12, 0.08), (1.12, 0.08), (0.30, 1.13), (-0.36, -1.13))
HANDLES = ((-0.95, 0.62, 90.0), (0.95, 0.98, 0.0), (-0.98, -0.90, 45.0), (0.98, -0.90, -45.0))
HARNESS_LIFT_M = 0.014
HARNESS_RADIUS_M = 0.008
LINE_RADIUS_M = 0.0035


def anti_earth_deck_parts() -> tuple[Part, ...]:
    """Return the fittings of the ring's side of the bus."""
    up = np.array([0.0, 0.0, FACE_Z_M])
    pieces = (
        ("star_trackers", _baffles(), "black_paint", True),
        ("star_trackers", _star_tracker_bodies(), "white_paint", False),
        ("sun_sensors", _sun_sensors(), "anodised_aluminium", False),
        ("sun_sensors", _sun_sensor_windows(), "solar_cell", False),
        ("handles", _handles(), "bare_aluminium", True),
        ("harness", _harness(), "black_paint", True),
        ("propellant_lines", _lines(), "bare_aluminium", True),
        ("telemetry_antenna", _telemetry_antenna(), "white_paint", True),
        ("service_panels", _panels(), "anodised_aluminium", False),
        ("service_panels", _caps(), "bare_aluminium", True),
    )
    return tuple(
        Part(name, shifted(mesh, up), material, smooth) for name, mesh, material, smooth in pieces
    )


def _baffles() -> trimesh.Trimesh:
    """Return the star trackers' baffles."""
    return joined(
        placed(cup(0.045, 0.085, 0.06, 0.24, 0.003, 36), standing((x, y, 0.03), axis))
        for (x, y), axis in STAR_TRACKERS
    )


def _star_tracker_bodies() -> trimesh.Trimesh:
    bodies = []
    for (x, y), axis in STAR_TRACKERS:
        bodies.append(
            placed(box((0.13, 0.13, 0.10), (0.0, 0.0, 0.012)), standing((x, y, 0.05), axis))
        )
        bodies.append(box((0.18, 0.18, 0.012), (x, y, 0.018)))
    return joined(bodies)


def _sun_sensors() -> trimesh.Trimesh:
    return joined(
        joined([box((0.075, 0.075, 0.05), (x, y, 0.028)), box((0.10, 0.10, 0.006), (x, y, 0.006))])
        for x, y in SUN_SENSORS
    )


def _sun_sensor_windows() -> trimesh.Trimesh:
    return joined(box((0.045, 0.045, 0.003), (x, y, 0.0545)) for x, y in SUN_SENSORS)


def _handles() -> trimesh.Trimesh:
    """Return the handles by which the satellite was turned on the ground: bent rods on feet."""
    angle = np.linspace(0.0, 0.5 * np.pi, 5)
    rise, half, bend = 0.058, 0.09, 0.03
    quarter = np.column_stack(
        [half - bend + bend * np.cos(angle), np.zeros(5), rise - bend + bend * np.sin(angle)]
    )
    path = np.concatenate(
        [[[half, 0.0, 0.004]], quarter, quarter[::-1] * [-1, 1, 1], [[-half, 0.0, 0.004]]]
    )
    handle = joined(
        [
            tube(path, 0.007, 10),
            *(shifted(cylinder(0.018, 0.002, 0.010, 16), (s * half, 0, 0)) for s in (-1.0, 1.0)),
        ]
    )
    return joined(
        placed(
            handle,
            standing(
                (x, y, 0.0), (0.0, 0.0, 1.0), (np.cos(np.deg2rad(t)), np.sin(np.deg2rad(t)), 0.0)
            ),
        )
        for x, y, t in HANDLES
    )


def _diagonal(sx: float, sy: float, aside: float, lift: float) -> Floats:
    """Return a run beside a diagonal seam, from the ring's foot to a corner, (n, 3) m."""
    along = np.array([sx, sy]) / np.sqrt(2.0)
    side = np.array([-along[1], along[0]])
    distance = np.linspace(0.885, 1.42, 12)
    sway = aside + 0.004 * np.sin(9.0 * distance + sx + 2.0 * sy)
    xy = distance[:, None] * along + sway[:, None] * side
    return np.column_stack([xy, np.full(12, lift)])


def _harness() -> trimesh.Trimesh:
    """Return the cable bundles to the thrusters and round the ring to its connectors, tied down."""
    runs = [_diagonal(sx, sy, 0.034, HARNESS_LIFT_M) for sx in (-1.0, 1.0) for sy in (-1.0, 1.0)]
    bundles = [tube(run, HARNESS_RADIUS_M, 8) for run in runs]
    angle = np.deg2rad(np.linspace(50.0, 220.0, 60))
    round_ring = np.column_stack(
        [0.893 * np.cos(angle), 0.893 * np.sin(angle), np.full(60, HARNESS_LIFT_M)]
    )
    tie = box((0.012, 0.030, 0.004), (0.0, 0.0, 0.008))
    ties = [shifted(tie, point) for run in runs for point in run[1:-1:3]]
    return joined([*bundles, tube(round_ring, 0.010, 8), *ties])


def _lines() -> trimesh.Trimesh:
    """Return the two propellant lines to each thruster cluster."""
    return joined(
        tube(_diagonal(sx, sy, aside, 0.009), LINE_RADIUS_M, 8)
        for sx in (-1.0, 1.0)
        for sy in (-1.0, 1.0)
        for aside in (-0.026, -0.038)
    )


def _telemetry_antenna() -> trimesh.Trimesh:
    """Return the wide-beam antenna on its mast."""
    mast = tube([[0.0, 1.06, 0.0], [0.0, 1.06, 0.20]], 0.016, 16)
    head = lathe(
        [
            (0.0, 0.20),
            (0.05, 0.20),
            (0.05, 0.215),
            (0.03, 0.23),
            (0.03, 0.27),
            (0.022, 0.29),
            (0.0, 0.30),
        ],
        32,
    )
    return joined(
        [
            mast,
            shifted(head, (0.0, 1.06, 0.0)),
            shifted(cylinder(0.05, 0.0, 0.012, 24), (0.0, 1.06, 0.0)),
        ]
    )


def _panels() -> trimesh.Trimesh:
    """Return the plates of the skin connectors and of the fill and drain valves."""
    pieces = [
        box((0.14, 0.34, 0.022), (1.03, 0.52, 0.013)),
        box((0.16, 0.30, 0.022), (-1.05, 0.30, 0.013)),
    ]
    for (x, y), (w, h) in (((1.03, 0.52), (0.06, 0.16)), ((-1.05, 0.30), (0.07, 0.14))):
        for sx in (-1.0, 1.0):
            for sy in (-1.0, 1.0):
                pieces.append(
                    shifted(prism(hexagon(0.011), 0.024, 0.030), (x + sx * w, y + sy * h, 0.0))
                )
    pieces += [bar((x, -1.15, 0.002), (x, -1.15, 0.028), 0.03, 0.05) for x in (-0.62, 0.30)]
    return joined(pieces)


def _caps() -> trimesh.Trimesh:
    """Return the connectors' caps and the valves' caps on those plates."""
    caps = [
        shifted(cylinder(0.020, 0.022, 0.044, 20), (1.03 + 0.032 * sx, y, 0.0))
        for sx in (-1.0, 1.0)
        for y in (0.42, 0.52, 0.62)
    ]
    valves = [
        shifted(
            lathe(
                [
                    (0.0, 0.02),
                    (0.017, 0.02),
                    (0.017, 0.055),
                    (0.010, 0.065),
                    (0.010, 0.085),
                    (0.0, 0.085),
                ],
                20,
            ),
            (-1.05, y, 0.0),
        )
        for y in (0.20, 0.27, 0.34, 0.41)
    ]
    return joined([*caps, *valves])
