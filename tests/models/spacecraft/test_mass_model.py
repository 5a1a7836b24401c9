"""Crude mass models against boxes of trimesh, and against what the spacecraft's parts measure."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from models.spacecraft import hispasat_layout, xmm_layout
from models.spacecraft.catalogue import spacecraft_by_name
from models.spacecraft.mass_model import (
    Lump,
    hispasat_lumps,
    mass_properties,
    maxar1300_lumps,
    xmm_lumps,
)
from models.spacecraft.maxar1300 import CENTRE_OF_MASS_M

CENTRE_M = 5e-3
THIN_M = 1e-3  # what trimesh wants of a sheet


def by_trimesh(lumps: tuple[Lump, ...]) -> tuple[float, np.ndarray, np.ndarray]:
    """Add up uniform boxes about their common centre of mass."""
    mass = sum(lump.mass_kg for lump in lumps)
    middle = sum(lump.mass_kg * np.array(lump.centre_m) for lump in lumps) / mass
    inertia = np.zeros((3, 3))
    for lump in lumps:
        box = trimesh.creation.box(np.maximum(lump.size_m, THIN_M))
        box.density = lump.mass_kg / box.volume
        box.apply_translation(np.array(lump.centre_m) - middle)
        inertia += box.moment_inertia_frame(np.eye(4))
    return mass, np.asarray(middle), inertia


@pytest.mark.parametrize(
    "lumps", [xmm_lumps(), hispasat_lumps(), maxar1300_lumps()], ids=["xmm", "hispasat", "maxar"]
)
def test_lumps_add_up_as_trimeshs_boxes_do(lumps: tuple[Lump, ...]) -> None:
    found, (mass, middle, inertia) = mass_properties(lumps), by_trimesh(lumps)
    assert found.mass_kg == pytest.approx(mass)
    np.testing.assert_allclose(found.centre_of_mass, middle, atol=1e-9)
    np.testing.assert_allclose(found.inertia, inertia, rtol=1e-4, atol=0.1)


def test_masses_are_those_at_launch_and_of_the_mirrors() -> None:
    """3764 kg with 1420 kg of mirrors (ESA 1999), 3220 kg (CNES 2017)."""
    assert mass_properties(xmm_lumps()).mass_kg == pytest.approx(3764.0)
    assert max(lump.mass_kg for lump in xmm_lumps()) == 1420.0
    assert mass_properties(hispasat_lumps()).mass_kg == pytest.approx(3220.0, abs=0.5)


def test_the_maxars_centre_of_mass_is_the_published_one() -> None:
    found = mass_properties(maxar1300_lumps())
    np.testing.assert_allclose(found.centre_of_mass, CENTRE_OF_MASS_M, atol=CENTRE_M)
    assert np.diag(found.inertia).argmin() == 1  # along the wings it is slender


def bounds_of(craft: str, *parts: str) -> np.ndarray:
    found = [p.mesh.bounds for p in spacecraft_by_name(craft).parts if p.name in parts]
    return np.stack([np.min([b[0] for b in found], axis=0), np.max([b[1] for b in found], axis=0)])


@pytest.mark.parametrize(("craft", "lump", "parts", "within_m"), [
    ("xmm", 1, ("service_module",), 0.03), ("xmm", 3, ("focal_plane_assembly",), 0.03),
    ("hispasat", 1, ("body",), 0.03),
])  # fmt: skip
def test_a_lump_that_stands_for_a_part_has_its_box(craft, lump, parts, within_m) -> None:
    """But for the foil, which bulges by 2 cm."""
    own = {"xmm": xmm_lumps, "hispasat": hispasat_lumps}[craft]()[lump]
    low, high = bounds_of(craft, *parts)
    np.testing.assert_allclose(np.array(own.centre_m), 0.5 * (low + high), atol=within_m)
    np.testing.assert_allclose(np.array(own.size_m), high - low, atol=2.0 * within_m)


@pytest.mark.parametrize("craft", ["xmm", "hispasat"])
def test_wings_lie_where_their_panels_do(craft: str) -> None:
    lumps = {"xmm": xmm_lumps, "hispasat": hispasat_lumps}[craft]()[-2:]
    layout = {"xmm": xmm_layout, "hispasat": hispasat_layout}[craft]
    assert lumps[0].mass_kg == lumps[1].mass_kg
    assert lumps[0].centre_m[1] == -lumps[1].centre_m[1]
    for lump in lumps:
        side = "plus_y" if lump.centre_m[1] > 0.0 else "minus_y"
        low, high = bounds_of(craft, f"solar_wing_{side}")
        assert lump.centre_m[1] == pytest.approx(0.5 * (low + high)[1], abs=0.03)
        assert lump.size_m[1] == pytest.approx((high - low)[1], abs=0.06)
        assert lump.centre_m[2] == pytest.approx(layout.WING_Z)


def test_a_tube_is_as_hard_to_turn_as_a_shell() -> None:
    """A square bar of side sqrt(6) R has m R^2 about its axis, as a shell of radius R has."""
    tube = xmm_lumps()[2]
    radius = 0.5 * (xmm_layout.LOWER_TUBE_M + xmm_layout.UPPER_TUBE_M)
    alone = mass_properties((tube,))
    assert alone.inertia[0, 0] == pytest.approx(tube.mass_kg * radius**2)
    low, high = bounds_of("xmm", "telescope_tube")
    assert tube.centre_m[0] == pytest.approx(0.5 * (low[0] + high[0]), abs=0.15)
    assert tube.size_m[0] == pytest.approx(6.7, abs=0.01)
