"""Creases change where light goes, not how much there is; unresolved, they are the mean."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from models.arrays import Floats
from models.camera import Camera
from models.materials import MATERIALS, Material
from models.spacecraft.part import Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from models.surface_detail import DETAIL, PLAIN
from renders.tracing.foil_creases import WIDEST_M, crease_slopes, lobe_factor
from renders.tracing.light_groups import SunGroup
from renders.tracing.surfaces import surface_of
from tests.support.small_scenes import camera_at, needs_jit, plate, rendered, run_python
from tests.support.surfaces import BANDS, seen_from

FOILS = sorted(name for name, detail in DETAIL.items() if detail.crease_slope > 0.0)
MEAN = 0.02
"""Of the factor over all places: slopes are nearly normal; where they are not it is 1.6 % off."""
PLACES = 100_000
FOOTPRINTS_M = (1e-6, 1.5e-3, 5e-3)


def on_a_plane(count: int, seed: int = 1) -> tuple[Floats, Floats, Floats]:
    """Return places over 3 m of a slanted plane, and two directions along it."""
    first = np.array([0.6, 0.48, 0.64])
    second = np.array([-0.8, 0.36, 0.48])
    at = np.random.default_rng(seed).uniform(-1.5, 1.5, (count, 2))
    return at @ np.stack([first, second]) + np.array([0.3, -2.0, 1.0]), first, second


@pytest.mark.parametrize("footprint_m", FOOTPRINTS_M)
def test_slopes_have_the_variance_that_is_told(footprint_m: float) -> None:
    places, first, second = on_a_plane(PLACES)
    slopes, variance = crease_slopes(np, tuple(places.T), np.full(PLACES, footprint_m))
    found = np.stack(slopes, axis=1)
    several_cells = 0.03  # 5,000 of the largest cells
    for along in (first, second):
        assert abs((found @ along).mean()) < several_cells
        assert (found @ along).var() == pytest.approx(variance[0], abs=several_cells)


def test_nothing_is_left_where_no_cell_is_resolved() -> None:
    places, *_ = on_a_plane(1000)
    slopes, variance = crease_slopes(np, tuple(places.T), np.full(1000, 1.01 * WIDEST_M))
    assert np.abs(slopes).max() == 0.0
    assert (variance == 0.0).all()


@pytest.mark.parametrize("name", FOILS)
@pytest.mark.parametrize("footprint_m", FOOTPRINTS_M)
def test_each_pair_of_directions_gets_its_mean(name: str, footprint_m: float) -> None:
    """At any slope of the half vector, out to 8 times the lobe's width, and to all sides."""
    places, first, second = on_a_plane(PLACES)
    rms, alpha = MATERIALS[name].detail.crease_slope, MATERIALS[name].roughness
    slopes, variance = crease_slopes(np, tuple(places.T), np.full(PLACES, footprint_m))
    found = rms * (np.stack(slopes, axis=1) @ np.stack([first, second]).T)
    for steep in alpha * np.array([0.0, 0.5, 1.0, 2.0, 4.0, 8.0]):
        for turn in (0.0, 1.0, 2.5):
            half = steep * np.array([np.cos(turn), np.sin(turn)])
            squared = (found**2).sum(axis=1)
            factor = lobe_factor(np, found @ half, steep**2, squared, alpha**2, rms**2 * variance)
            assert factor.mean() == pytest.approx(1.0, abs=MEAN)
            most = 7.0  # no place is a firefly
            assert 0.0 < factor.min() < factor.max() < most


def test_dr_jit_and_numpy_find_the_same_foil() -> None:
    needs_jit()
    import drjit as dr
    import mitsuba as mi

    places, *_ = on_a_plane(20_000)
    single = places.astype(np.float32)
    ours, _ = crease_slopes(np, tuple(single.astype(np.float64).T), np.full(20_000, 1e-4))
    theirs, _ = crease_slopes(dr, mi.Point3f(*single.T), mi.Float(1e-4))
    off = np.abs(np.stack(ours) - np.stack([np.array(each) for each in theirs])).max(axis=0)
    single_precision, on_a_border = 5e-3, 2e-3  # a place on a cell's border falls to either side
    assert (off > single_precision).mean() < on_a_border


def albedo(name: str, incidence_deg: float, places: Floats | None) -> Floats:
    """Return the directional albedo of each band at some places, (3, n), by one set of draws."""
    import mitsuba as mi

    angle = np.deg2rad(incidence_deg)
    viewer = np.array([[np.sin(angle)], [0.0], [np.cos(angle)]])
    draws = 1024
    i, j = np.divmod(np.arange(draws), 32)
    square = (np.stack([i, j]) + 0.5) / 32.0
    count = 1 if places is None else len(places)
    viewers = np.broadcast_to(viewer, (3, draws * count))
    seen = seen_from(surface_of(MATERIALS[name]), viewers)
    if places is not None:
        at = np.repeat(places, draws, axis=0).astype(np.float32)
        seen.look_closely(mi.Point3f(*at.T), seen.normal, mi.Float(1.0), mi.Float(1e-6))
    weights = seen.sample(mi.Point2f(np.tile(square, count).astype(np.float32)))[2]
    return np.stack([np.array(weights[band]).reshape(count, draws).mean(axis=1) for band in BANDS])


@pytest.mark.parametrize("name", FOILS)
@pytest.mark.parametrize("incidence_deg", [0.0, 45.0, 75.0])
def test_the_furnace_holds_on_creased_foil(name: str, incidence_deg: float) -> None:
    needs_jit()
    plain = albedo(name, incidence_deg, None)
    at = np.random.default_rng(2).uniform(-1.0, 1.0, (1000, 3)) * [1.0, 1.0, 0.0]
    here = albedo(name, incidence_deg, at)
    scatter = 4.0 * here.std(axis=1) / np.sqrt(1000)
    assert (np.abs(here.mean(axis=1) / plain[:, 0] - 1.0) < MEAN + scatter / plain[:, 0]).all()
    assert here.max() < 1.0  # no place sends back more than it gets


CAMERA = Camera(width=48, height=48, fx=1500.0, fy=1500.0, cx=23.5, cy=23.5)
POSE = camera_at(np.array([0.0, 0.0, 1.2]))
TILTED = SunGroup("sun", (0.12, 0.05, 0.99))
PROGRAM = """
import numpy as np
from renders.variant.choice import activate
activate("scalar_rgb")
from tests.renders.tracing.test_foil_creases import seeds
np.save("scalar.npy", seeds(0))
"""


def seeds(first: int) -> Floats:
    """Return (seed, 48, 48) light of foil from nearby over the mean of foil without creases.

    Both are of the variant that is active: the two families' plain lobes differ by 0.1 % here.
    """
    plain = foil(first, replace(MATERIALS["mli_gold"], detail=PLAIN)).mean()
    return np.stack([foil(seed) for seed in range(first, first + 5)]) / plain


def foil(seed: int, material: Material = MATERIALS["mli_gold"]) -> Floats:
    from renders.tracing.radiance import Sampling, render_radiance
    from renders.tracing.scene import build_geometry

    craft = replace(plate("mli_gold"), materials={"mli_gold": material})
    geometry = build_geometry(craft, None, RetroreflectorOptics())
    sampling = Sampling(16, 16, 1, 1000 * seed)
    found = render_radiance(geometry.scene(), geometry, CAMERA, POSE, [TILTED], None, sampling)
    return found["sun"]


@pytest.mark.slow
def test_scalar_and_jit_see_the_same_creases(tmp_path: Any) -> None:
    needs_jit()
    from tests.support.image_statistics import same_image

    jit = seeds(100)
    done = run_python(PROGRAM, tmp_path)
    assert done.returncode == 0, done.stderr
    scalar = np.load(tmp_path / "scalar.npy")
    verdict = same_image(jit, scalar)
    assert verdict, str(verdict)
    assert jit.mean(axis=0).std() > 0.3 * jit.mean()  # there is something to see
    assert not same_image(jit, scalar[:, ::-1])


def test_foil_has_the_same_light_from_near_and_far() -> None:
    """The same metre of it in pixels of 8 cm, which resolve nothing, and of 4 mm."""
    needs_jit()
    pose = camera_at(np.array([0.0, 0.0, 50.0]))
    wide = Camera(width=16, height=16, fx=600.0, fy=600.0, cx=7.5, cy=7.5)
    fine = Camera(width=320, height=320, fx=12000.0, fy=12000.0, cx=159.5, cy=159.5)
    craft: Spacecraft = plate("mli_gold", 3.0)
    far = rendered(craft, wide, pose, [TILTED], 64)["sun"]
    near = rendered(craft, fine, pose, [TILTED], 16)["sun"]
    material = replace(MATERIALS["mli_gold"], detail=PLAIN)
    plain = replace(craft, materials={"mli_gold": material})
    np.testing.assert_allclose(far, rendered(plain, wide, pose, [TILTED], 64)["sun"], rtol=2e-2)
    a_few_cells = 0.03  # 1,000 of the largest cells, whose factors scatter by 0.7
    assert near.mean() == pytest.approx(far.mean(), rel=MEAN + a_few_cells)
    assert near.std() > 0.3 * near.mean()
