"""XMM-Newton's service module, the mirrors' end of the telescopes in it, and its sunshield.

A closed box of two platforms and four side panels in black foil, with the launcher's ring, the
three mirror baffles and the optical monitor's on the side of the sky; the doors, opened for good,
lie against their baffles. The telescope sunshield stands round the Sun's side of all that, bright
outside and black within. Boxes with pairs of thrusters on top and a tripod with an S-band antenna
are what the craft's own cameras show from the tube's other end ("Space selfie from XMM-Newton",
ESA 2016).
"""

from __future__ import annotations

import numpy as np
import trimesh

from models.arrays import Floats
from models.spacecraft import xmm_layout as at
from models.spacecraft.foil import box_foil, quad_foil
from models.spacecraft.mirror_panel import mirror_panel
from models.spacecraft.part import Part
from models.spacecraft.solids import (
    bar,
    box,
    cup,
    cylinder,
    joined,
    lathe,
    mesh_of,
    placed,
    shifted,
    standing,
)
from models.spacecraft.thruster import nozzle
from models.spacecraft.xmm_telescope import BLANKET_M, FACET_M, FOIL, RELIEF_M, along_x
from models.spacecraft.xmm_wireframe import SIDES, baffle_centres, shield_corners

SUN_FOIL = "mli_gold"
SHIELD_RELIEF_M = 0.016
RADIATOR_M = (0.62, 1.30)  # along x and along z, on the +-y sides
RADIATOR_Z = -0.55
DOOR_M = 0.46
TRIPODS = (((1.06, -0.95, -1.50), -1.0), ((1.85, 1.05, 1.50), 1.0))  # foot, and side along z


def service_module_parts() -> tuple[Part, ...]:
    """Return the service module and everything on its side of the sky."""
    panels, mirrors = _radiators()
    return (
        Part("service_module", _structure(), "carbon_fibre"),
        Part("service_module", _foil(), FOIL, smooth=True),
        Part("service_radiators", panels, "white_paint"),
        Part("service_radiators", mirrors, "optical_solar_reflector"),
        Part("launch_adaptor_ring", _ring(), "bare_aluminium", smooth=True),
        Part("mirror_baffles", _baffles(), "black_paint", smooth=True),
        Part("mirror_doors", _doors(), "anodised_aluminium", smooth=True),
        Part("star_trackers", _star_trackers(), "black_paint", smooth=True),
        Part("sunshield", _shield_panels(), FOIL),
        Part("sunshield", _shield_foil(), SUN_FOIL, smooth=True),
        Part("thruster_pods", _pods(), FOIL),
        Part("thrusters", _thrusters(), "titanium_nozzle", smooth=True),
        Part("s_band_antennas", _tripods(), "carbon_fibre"),
        Part("s_band_antennas", _antennas(), "white_paint", smooth=True),
    )


def service_bounds() -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Return the lowest and the highest corner of the service module's box, m."""
    y, z = at.SERVICE_HALF_Y, at.SERVICE_HALF_Z
    return (at.SERVICE_X[0], -y, -z), (at.SERVICE_X[1], y, z)


def _structure() -> trimesh.Trimesh:
    low, high = (np.array(end) for end in service_bounds())
    return box(high - low - 2.0 * BLANKET_M, 0.5 * (low + high))


def _foil() -> trimesh.Trimesh:
    """Return the foil; round the tube and inside the launcher's ring there is none."""
    low, high = service_bounds()
    y, z = at.SERVICE_HALF_Y, at.SERVICE_HALF_Z
    holes = {"+x": (y, z, at.ADAPTOR_M - 0.03), "-x": (z, y, at.LOWER_TUBE_M - 0.03)}
    return box_foil(low, high, FACET_M, 1950, RELIEF_M, holes)


def _radiators() -> tuple[trimesh.Trimesh, trimesh.Trimesh]:
    """Return the panels on the +-y sides and the mirrors on them."""
    middle = 0.5 * sum(at.SERVICE_X)
    places = [
        standing((middle, sign * at.SERVICE_HALF_Y, RADIATOR_Z), (0.0, sign, 0.0), (1.0, 0.0, 0.0))
        for sign in SIDES.values()
    ]
    panel, mirrors = mirror_panel(RADIATOR_M, 0.020, 1960)
    return (
        joined(placed(panel, place) for place in places),
        joined(placed(mirrors, place) for place in places),
    )


def _ring() -> trimesh.Trimesh:
    """Return the launcher's interface ring, which stayed with the craft."""
    x, outer, inner = at.SERVICE_X[1], at.ADAPTOR_M, at.ADAPTOR_M - 0.05
    outline = [
        (inner, x - 0.01),
        (outer, x - 0.01),
        (outer, x + 0.13),
        (inner, x + 0.13),
        (inner, x - 0.01),
    ]
    return placed(lathe(outline, 96), along_x())


def _baffles() -> trimesh.Trimesh:
    """Return the entrance baffles of the three telescopes and of the optical monitor."""
    foot = at.SERVICE_X[1] - 0.02
    baffle = cup(at.BAFFLE_M - 0.03, at.BAFFLE_M, foot, at.BAFFLE_X, 0.012, 64)
    monitor = cup(0.17, 0.17, foot, at.BAFFLE_X + 0.12, 0.008, 40)
    return joined(
        [
            *(placed(baffle, along_x(y, z)) for y, z in baffle_centres()),
            placed(monitor, along_x(-0.62, -0.72)),
        ]
    )


def _doors() -> trimesh.Trimesh:
    """Return the doors, swung back until each lies along its baffle, faces outward."""
    pieces = []
    for y, z in baffle_centres():
        outward = np.array([0.0, y, z]) / np.hypot(y, z)
        centre = (1.0 + (at.BAFFLE_M + 0.06) / np.hypot(y, z)) * np.array([0.0, y, z])
        centre[0] = at.BAFFLE_X - 0.36
        door = cylinder(DOOR_M, 0.0, 0.035, 64)
        pieces.append(placed(door, standing(centre, outward, (1.0, 0.0, 0.0))))
    return joined(pieces)


def _star_trackers() -> trimesh.Trimesh:
    foot = at.SERVICE_X[1] - 0.01
    tracker = cup(0.08, 0.14, foot, foot + 0.48, 0.006, 36)
    return joined(placed(tracker, along_x(y, -1.28)) for y in (0.52, 0.90))


def shield_quads() -> list[Floats]:
    """Return the sunshield's three panels, (4, 3) m each, counter-clockwise seen from the Sun."""
    left, right = shield_corners(-1.0), shield_corners(1.0)
    return [
        right[[3, 0, 1, 2]],
        np.array([right[3], left[3], left[0], right[0]]),
        left[[2, 1, 0, 3]],
    ]


def _shield_panels() -> trimesh.Trimesh:
    return joined(_slab(corners, at.SHIELD_M) for corners in shield_quads())


def _slab(corners: Floats, thickness_m: float) -> trimesh.Trimesh:
    """Return a flat quadrilateral with half of its thickness on either side."""
    normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
    normal *= 0.5 * thickness_m / np.linalg.norm(normal)
    ring = np.arange(4)
    after = (ring + 1) % 4
    faces = [[4, 5, 6], [4, 6, 7], [0, 2, 1], [0, 3, 2]]
    faces += np.stack([ring, after, after + 4], axis=-1).tolist()
    faces += np.stack([ring, after + 4, ring + 4], axis=-1).tolist()
    return mesh_of(np.concatenate([corners - normal, corners + normal]), faces)


def _shield_foil() -> trimesh.Trimesh:
    pieces = []
    for number, corners in enumerate(shield_quads()):
        normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
        normal /= np.linalg.norm(normal)
        foil = quad_foil(corners, 0.045, 1970 + number, SHIELD_RELIEF_M)
        pieces.append(shifted(foil, (0.5 * at.SHIELD_M + 0.001) * normal))
    return joined(pieces)


def _pods() -> trimesh.Trimesh:
    x = at.SERVICE_X[0] - 0.5 * at.POD_M[0]
    return joined(box(at.POD_M, (x, y, z)) for y, z in at.PODS_YZ)


def _thrusters() -> trimesh.Trimesh:
    """Return a pair of nozzles on each pod, one outward along y and one along z."""
    x = at.SERVICE_X[0] - at.POD_M[0] + 0.09
    pieces = []
    for y, z in at.PODS_YZ:
        for axis, reach in ((1, at.POD_M[1]), (2, at.POD_M[2])):
            way = np.zeros(3)
            way[axis] = np.sign((0.0, y, z)[axis])
            pieces.append(placed(nozzle(), standing(np.array([x, y, z]) + 0.5 * reach * way, way)))
    return joined(pieces)


def _tripods() -> trimesh.Trimesh:
    legs = []
    for foot, side in TRIPODS:
        top = np.array(foot) + np.array([0.0, 0.0, 0.55 * side])
        for turn in np.deg2rad([90.0, 210.0, 330.0]):
            stand = np.array([0.10 * np.sin(turn), 0.18 * np.cos(turn), -0.02 * side])
            stand[0] = np.clip(foot[0] + stand[0], *at.SERVICE_X) - foot[0]
            legs.append(bar(np.array(foot) + stand, top, 0.022, 0.022))
    return joined(legs)


def _antennas() -> trimesh.Trimesh:
    outline = [(0.0, 0.0), (0.10, 0.0), (0.10, 0.02), (0.045, 0.05), (0.045, 0.18), (0.0, 0.20)]
    return joined(
        placed(
            lathe(outline, 32),
            standing(np.array(foot) + np.array([0.0, 0.0, 0.54 * side]), (0.0, 0.0, side)),
        )
        for foot, side in TRIPODS
    )
