"""GPS and Galileo as their documents place them: circles about the Earth.

References
----------
GPS Standard Positioning Service Performance Standard, 2008, table A.2-1: the 24 slots, by plane, on
1 July 1993; beside them one spare a plane, in the middle of its widest gap, which makes the 30
satellites of today. Galileo: European GNSS Open Service Signal-in-Space ICD: Walker 24/3/1, and
here, if asked, two spares a plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from models.arrays import Floats
from models.gravity.field import MU_M3_S2

GPS_AXIS_M, GPS_INCLINATION_DEG, GPS_FIRST_NODE_DEG = 26_559_700.0, 55.0, 272.847
GPS_SLOTS_DEG = (
    (11.676, 41.806, 161.786, 268.126),
    (80.956, 173.336, 204.376, 309.976),
    (11.796, 111.876, 241.556, 339.666),
    (35.156, 135.226, 167.356, 265.446),
    (66.066, 197.046, 302.596, 333.686),
    (105.206, 135.346, 238.886, 345.226),
)
GALILEO_AXIS_M, GALILEO_INCLINATION_DEG = 29_599_800.0, 56.0
GALILEO_PLANES, GALILEO_A_PLANE = 3, 8


@dataclass(frozen=True, eq=False)
class Constellation:
    """Satellites on circles.

    Attributes
    ----------
    names : tuple of n str
        ``G01`` ..., ``E01`` ...
    axis_m : (n,) array, m
    inclination_rad, node_rad, argument_rad : (n,) array, rad
        Argument of latitude at time zero.
    """

    names: tuple[str, ...]
    axis_m: Floats
    inclination_rad: Floats
    node_rad: Floats
    argument_rad: Floats

    def __len__(self) -> int:
        return len(self.names)

    def states(self, times_s: Floats) -> Floats:
        """Return inertial positions and velocities, (m, n, 6), m and m/s, at times (m,) in s."""
        rate = np.sqrt(MU_M3_S2 / self.axis_m**3)
        argument = self.argument_rad + rate * np.asarray(times_s)[:, None]
        node, tilt = self.node_rad, self.inclination_rad
        ascending = np.stack([np.cos(node), np.sin(node), np.zeros_like(node)], axis=-1)
        across = np.stack(
            [-np.sin(node) * np.cos(tilt), np.cos(node) * np.cos(tilt), np.sin(tilt)], axis=-1
        )
        s, c = np.sin(argument)[..., None], np.cos(argument)[..., None]
        radius, speed = self.axis_m[:, None], (self.axis_m * rate)[:, None]
        place = radius * (c * ascending + s * across)
        return np.concatenate([place, speed * (c * across - s * ascending)], axis=-1)


@lru_cache(maxsize=4)
def gps_and_galileo(galileo_spares: bool = False) -> Constellation:
    """Return both constellations: 30 GPS, 24 Galileo satellites, or 30 of them with spares."""
    gps = [
        (GPS_AXIS_M, GPS_INCLINATION_DEG, GPS_FIRST_NODE_DEG + 60.0 * plane, slot)
        for plane, slots in enumerate(GPS_SLOTS_DEG)
        for slot in (*slots, _middle_of_widest_gap(slots))
    ]
    spacing = 360.0 / GALILEO_A_PLANE
    galileo = [
        (
            GALILEO_AXIS_M,
            GALILEO_INCLINATION_DEG,
            120.0 * plane,
            spacing * place + 360.0 / (GALILEO_PLANES * GALILEO_A_PLANE) * plane,
        )
        for plane in range(GALILEO_PLANES)
        for place in (*range(GALILEO_A_PLANE), *((0.5, 4.5) if galileo_spares else ()))
    ]
    table = np.array(gps + galileo)
    names = [f"G{k + 1:02d}" for k in range(len(gps))]
    names += [f"E{k + 1:02d}" for k in range(len(galileo))]
    angles = np.deg2rad(table[:, 1:])
    return Constellation(tuple(names), table[:, 0], *angles.T)


def _middle_of_widest_gap(slots_deg: tuple[float, ...]) -> float:
    ends = [*slots_deg[1:], slots_deg[0] + 360.0]
    gap, start = max((end - start, start) for start, end in zip(slots_deg, ends, strict=True))
    return (start + 0.5 * gap) % 360.0
