"""Hispasat 36W-1's box: gold foil to east, west and the launcher, mirrors north and south.

The ring and the apogee engine on the deck that looks away from the Earth are those of the
Maxar-1300, a class of fittings that any satellite of this size carries.
"""

from __future__ import annotations

import numpy as np
import trimesh

from models.pose import RigidTransform
from models.spacecraft import bus
from models.spacecraft import hispasat_layout as at
from models.spacecraft.apogee_engine import apogee_engine_parts
from models.spacecraft.foil import box_foil
from models.spacecraft.launch_adaptor_ring import launch_adaptor_ring_parts
from models.spacecraft.mirror_panel import mirror_panel
from models.spacecraft.part import Part
from models.spacecraft.solids import box, holed_square, joined, placed, shifted, standing
from models.spacecraft.thruster import nozzle

BLANKET_M = 0.012  # the panels lie this far inside the held-down foil
RELIEF_M, FACET_M = 0.010, 0.045
DECK_FOIL, FOIL = "mli_black", "mli_gold"
DRIVE_CLEAR_M = 0.20  # no mirrors round the solar array drive


def body_parts() -> tuple[Part, ...]:
    """Return the box, its foil and radiators, and the fittings of the launcher's side."""
    panels, mirrors = _radiators()
    ring_side = RigidTransform(
        np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, at.BODY_LOW[2] + bus.FACE_Z_M])
    )
    fittings = (*launch_adaptor_ring_parts(), *apogee_engine_parts())
    return (
        Part("body", _structure(), "bare_aluminium"),
        Part("body", _foil(("+y", "-y", "+z")), FOIL, smooth=True),
        Part("body", _foil(("+x", "-x", "+y", "-y", "-z")), DECK_FOIL, smooth=True),
        Part("body", _sides(), "white_paint"),
        Part("radiators", panels, "white_paint"),
        Part("radiators", mirrors, "optical_solar_reflector"),
        Part("thrusters", _thrusters(), "titanium_nozzle", smooth=True),
        *(Part(p.name, placed(p.mesh, ring_side), p.material, p.smooth) for p in fittings),
    )


def _structure() -> trimesh.Trimesh:
    """Return the box inside the foil, with the engine's well in the launcher's side."""
    low, high = np.array(at.BODY_LOW) + BLANKET_M, np.array(at.BODY_HIGH) - BLANKET_M
    deck, t = low[2], bus.PANEL_M
    size, middle = high - low, 0.5 * (low + high)
    floor = shifted(holed_square(high[1], bus.ENGINE_WELL_M, 0.0, t, 64), (0.0, 0.0, deck))
    sides = [
        box((high[0] - high[1], size[1], t), (s * 0.5 * (high[0] + high[1]), 0.0, deck + 0.5 * t))
        for s in (-1.0, 1.0)
    ]
    walls = [
        box((t, size[1], size[2] - 2 * t), (s * (high[0] - 0.5 * t), 0.0, middle[2]))
        for s in (-1.0, 1.0)
    ] + [
        box((size[0] - 2 * t, t, size[2] - 2 * t), (0.0, s * (high[1] - 0.5 * t), middle[2]))
        for s in (-1.0, 1.0)
    ]
    return joined([floor, *sides, *walls, box((*size[:2], t), (0.0, 0.0, high[2] - 0.5 * t))])


def _foil(bare: tuple[str, ...]) -> trimesh.Trimesh:
    """Return foil on the faces that are not ``bare``, open round the launcher's ring."""
    x, y = at.BODY_HIGH[:2]
    holes = {"-z": (y, x, bus.RING_CUTOUT_M)}
    return box_foil(at.BODY_LOW, at.BODY_HIGH, FACET_M, 3610, RELIEF_M, holes, bare)


def _sides() -> trimesh.Trimesh:
    """Return the painted panels of the +-y faces, a millimetre short of the foil on the others."""
    (x, y, top), bottom = at.BODY_HIGH, at.BODY_LOW[2]
    size = (2.0 * x - 0.002, BLANKET_M, top - bottom - 0.002)
    return joined(
        box(size, (0.0, s * (y - 0.5 * BLANKET_M), 0.5 * (top + bottom))) for s in (-1.0, 1.0)
    )


def _radiators() -> tuple[trimesh.Trimesh, trimesh.Trimesh]:
    """Return the panels on the +-y faces and the mirrors on them."""
    drive = (0.0, at.WING_Z - at.RADIATOR_Z, DRIVE_CLEAR_M)
    panel, mirrors = mirror_panel(at.RADIATOR_M, 0.004, 3620, drive)
    places = [
        standing((0.0, s * at.BODY_HIGH[1], at.RADIATOR_Z), (0.0, s, 0.0), (-s, 0.0, 0.0))
        for s in (-1.0, 1.0)
    ]
    return (
        joined(placed(panel, place) for place in places),
        joined(placed(mirrors, place) for place in places),
    )


def _thrusters() -> trimesh.Trimesh:
    """Return four pairs of nozzles near the corners of the launcher's side."""
    z = at.BODY_LOW[2] - 0.02
    pieces = []
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            foot = np.array([sx * 1.0, sy * 0.80, z])
            for lean in (0.0, 0.6):
                pieces.append(placed(nozzle(), standing(foot, (sx * lean, 0.0, -1.0))))
    return joined(pieces)
