"""Crude mass models: a spacecraft as a few uniform boxes and shells, to place its centre of mass.

Pesce et al. 2019, equations 13 and 14, do the same "with elementary volumes" and warn that it is
crude; motion uses their matrices as printed. Ours, about the centre of mass, in kg m2:

=========  =====================  ==========================
craft      Pesce et al. 2019      these boxes
=========  =====================  ==========================
XMM        7052, 129129, 131196   XMM_INERTIA
Hispasat   6396, 3703, 5918       HISPASAT_INERTIA
=========  =====================  ==========================

The printed moments of XMM about y and z ask for a mean distance of 5.8 m from the axis at 3800 kg,
more than half of the craft's length: they cannot be taken about its centre of mass, but fit a rod
turned about its end (3800 kg, 10.8 m: 147744). Masses are published where said, else ours.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.spacecraft import bus, hispasat_layout, offset_reflector, solar_wing, xmm_layout


@dataclass(frozen=True)
class Lump:
    """A uniform box along the body's axes.

    Attributes
    ----------
    mass_kg : float
    centre_m, size_m : (float, float, float), m
    """

    mass_kg: float
    centre_m: tuple[float, float, float]
    size_m: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class MassProperties:
    """What lumps add up to.

    Attributes
    ----------
    mass_kg : float
    centre_of_mass : (3,) array, m
    inertia : (3, 3) array, kg m2
        About the centre of mass, products with the sign of the matrix: ``-sum m x y``.
    """

    mass_kg: float
    centre_of_mass: Floats
    inertia: Floats


def mass_properties(lumps: tuple[Lump, ...]) -> MassProperties:
    """Return mass, centre of mass and inertia of some lumps together."""
    mass = np.array([lump.mass_kg for lump in lumps])
    centres = np.array([lump.centre_m for lump in lumps])
    sizes = np.array([lump.size_m for lump in lumps])
    middle = mass @ centres / mass.sum()
    arms = centres - middle
    second = np.einsum("n,ni,nj->ij", mass, arms, arms) + np.diag(mass @ sizes**2) / 12.0
    return MassProperties(float(mass.sum()), middle, np.trace(second) * np.eye(3) - second)


def _between(ends: tuple[float, float]) -> tuple[float, float]:
    return 0.5 * (ends[0] + ends[1]), ends[1] - ends[0]


def xmm_lumps() -> tuple[Lump, ...]:
    """Return XMM-Newton at launch, 3764 kg; its three mirror modules are 1420 kg of that.

    ("XMM receives its golden eyes", ESA, April 1999.) The tube stands for a square shell's mean.
    """
    at = xmm_layout
    service_x, service_length = _between(at.SERVICE_X)
    focal_x, focal_length = _between(at.FOCAL_X)
    tube_x, tube_length = _between((at.FOCAL_X[1], at.SERVICE_X[0]))
    shield_x, shield_length = _between((at.SERVICE_X[1], at.SUNSHIELD_TOP_X))
    wing_y, wing_length = _between((at.WING.inner_m, at.WING.tip_m))
    tube_size = np.sqrt(6.0) * 0.5 * (at.LOWER_TUBE_M + at.UPPER_TUBE_M)  # a shell's inertia
    return (
        Lump(1420.0, (service_x - 0.05, 0.0, 0.0), (1.5, 1.9, 1.9)),
        Lump(
            1350.0,
            (service_x, 0.0, 0.0),
            (service_length, 2.0 * at.SERVICE_HALF_Y, 2.0 * at.SERVICE_HALF_Z),
        ),
        Lump(280.0, (tube_x, 0.0, 0.0), (tube_length, tube_size, tube_size)),
        Lump(
            560.0,
            (focal_x, 0.0, 0.5 * sum(at.FOCAL_Z)),
            (focal_length, 2.0 * at.FOCAL_HALF_Y, at.FOCAL_Z[1] - at.FOCAL_Z[0]),
        ),
        Lump(54.0, (shield_x, 0.0, 1.1), (shield_length, 2.6, 0.5)),
        *(
            Lump(50.0, (at.WING_X, sign * wing_y, at.WING_Z), (at.WING.panel_m[0], wing_length, 0))
            for sign in (-1.0, 1.0)
        ),
    )


def hispasat_lumps() -> tuple[Lump, ...]:
    """Return Hispasat 36W-1 at launch, 3220 kg (CNES, January 2017), its tanks full."""
    at = hispasat_layout
    low, high = np.array(at.BODY_LOW), np.array(at.BODY_HIGH)
    middle, size = 0.5 * (low + high), high - low
    wing_y, wing_length = _between((at.WING.inner_m, at.WING.tip_m))
    return (
        Lump(1500.0, (0.0, 0.0, -0.25), (1.2, 1.0, 1.4)),
        Lump(1580.0, (middle[0], middle[1], middle[2]), (size[0], size[1], size[2])),
        *(
            Lump(22.0, (sign * at.DISH.centre_x_m, 0.0, 0.3), (1.8, 1.8, 0.3))
            for sign in (-1.0, 1.0)
        ),
        *(
            Lump(48.0, (0.0, sign * wing_y, at.WING_Z), (2.0, wing_length, 0.9))
            for sign in (-1.0, 1.0)
        ),
    )


def maxar1300_lumps() -> tuple[Lump, ...]:
    """Return a Maxar-1300 some years into its life, 4290 kg, axes and origin of TGFF.

    No drawing of its tanks is public: theirs lie so that the centre of mass is the one of Opromolla
    et al. 2022, 1.8 m behind the ring.
    """
    body_z, body_length = _between((bus.EARTH_FACE_Z_M, bus.FACE_Z_M))
    wing_y, wing_length = _between((solar_wing.WING.inner_m, solar_wing.WING.tip_m))
    return (
        Lump(2600.0, (0.0, 0.0, body_z), (bus.WIDTH_M, bus.WIDTH_M, body_length)),
        Lump(1400.0, (0.0, 0.0, -1.47), (1.3, 1.3, 1.8)),
        *(
            Lump(35.0, (sign * offset_reflector.DISH.centre_x_m, 0.0, -2.4), (2.0, 2.0, 0.8))
            for sign in (-1.0, 1.0)
        ),
        *(
            Lump(
                110.0,
                (0.0, sign * wing_y, solar_wing.WING_Z_M),
                (solar_wing.WING.panel_m[0], wing_length, 0.0),
            )
            for sign in (-1.0, 1.0)
        ),
    )
