"""The kernel's surfaces against Mitsuba's own BSDFs, which share no code with them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arrays import Floats
from models.materials import MATERIALS
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.tracing.surfaces import Surface, bsdf_dict, surface_of, surface_of_disc
from tests.support.small_scenes import needs_jit
from tests.support.surfaces import BANDS, density, density_back, drawn, seen_from, value

NAMES = sorted(MATERIALS)
FLOAT32 = 2e-3  # half vectors at grazing incidence lose digits, and the lobe's peak most of them
PAIRS = 20_000


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    needs_jit()


def directions(seed: int, above: bool = True) -> Floats:
    rng = np.random.default_rng(seed)
    cosine = rng.uniform(0.02 if above else -1.0, 1.0, PAIRS)
    turn = rng.uniform(0.0, 2.0 * np.pi, PAIRS)
    sine = np.sqrt(1.0 - cosine**2)
    return np.stack([sine * np.cos(turn), sine * np.sin(turn), cosine])


def near_the_mirror_direction(viewer: Floats, spread: float) -> Floats:
    mirrored = viewer * np.array([[-1.0], [-1.0], [1.0]])
    mirrored += np.random.default_rng(3).normal(scale=spread, size=mirrored.shape)
    return np.asarray(mirrored / np.linalg.norm(mirrored, axis=0))


def by_mitsuba(surface: Surface, viewer: Floats, light: Floats) -> tuple[Floats, Floats]:
    """Return ``f cos`` of each band and the density, by the plugins that scalar variants use."""
    import drjit as dr
    import mitsuba as mi

    bsdf = mi.load_dict(bsdf_dict(surface))
    si = dr.zeros(mi.SurfaceInteraction3f, PAIRS)
    si.wi = mi.Vector3f(viewer)
    value, density = bsdf.eval_pdf(mi.BSDFContext(), si, mi.Vector3f(light), True)
    return np.array(value, dtype=float), np.array(density, dtype=float)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("two_sided", [True, False])
def test_what_a_material_returns_is_what_mitsubas_plugins_return(
    name: str, two_sided: bool
) -> None:
    surface = replace(surface_of(MATERIALS[name]), two_sided=two_sided)
    viewer = directions(1, above=False)
    for light in (directions(2, above=False), near_the_mirror_direction(viewer, 0.1)):
        theirs, _ = by_mitsuba(surface, viewer, light)
        grazing = np.minimum(np.abs(viewer[2]), np.abs(light[2])) < 0.02
        ours = value(surface, viewer, light)
        np.testing.assert_allclose(ours[:, ~grazing], theirs[:, ~grazing], rtol=FLOAT32, atol=1e-5)
        assert (theirs > 0.0).any()


@pytest.mark.parametrize("name", ["mli_gold", "white_paint", "bare_aluminium"])
def test_a_metals_directions_have_mitsubas_density(name: str) -> None:
    """A dielectric's do not: the blend draws its face as often as if it reflected everything."""
    surface = surface_of(MATERIALS[name])
    viewer = directions(1)
    light = near_the_mirror_direction(viewer, 0.2)
    _, theirs = by_mitsuba(surface, viewer, light)
    ours = density(surface, viewer, light)
    steep = np.minimum(viewer[2], light[2]) > 0.05
    np.testing.assert_allclose(ours[steep], theirs[steep], rtol=FLOAT32, atol=1e-5)


@pytest.mark.parametrize("name", NAMES)
def test_weights_are_value_over_density(name: str) -> None:
    surface = surface_of(MATERIALS[name])
    viewer = np.array([[0.6], [0.0], [0.8]])
    square = np.random.default_rng(5).random((2, PAIRS))
    towards, weights = drawn(surface, viewer, square)
    used = weights.any(axis=0)
    expected = value(surface, viewer, towards)[:, used] / density(surface, viewer, towards)[used]
    np.testing.assert_allclose(weights[:, used], expected, rtol=FLOAT32)
    assert used.mean() > 0.8


@settings(max_examples=25, deadline=None)
@given(
    share=st.floats(0.02, 0.98),
    cosine=st.floats(0.1, 1.0),
    roughness=st.floats(0.05, 0.6),
)
def test_the_furnace_holds_for_any_metal(share: float, cosine: float, roughness: float) -> None:
    """The mean weight is what comes back of light from everywhere: at most 1, at any split."""
    surface = Surface((1.0 - share,) * 3, (share,) * 3, roughness)
    viewer = np.array([[np.sqrt(1.0 - cosine**2)], [0.0], [cosine]])
    square = np.random.default_rng(6).random((2, 4 * PAIRS))
    _, weights = drawn(surface, viewer, square)
    sigma = weights.std(axis=1) / np.sqrt(weights.shape[1])
    sigmas = 4.5  # of 75 values, one in 4,000 tries has one beyond
    assert (weights.mean(axis=1) <= 1.0 + sigmas * sigma + FLOAT32).all()
    assert (weights.mean(axis=1) >= (1.0 - share) * 0.9).all()


def test_evenly_spread_points_stay_so_within_each_lobe() -> None:
    """The choice of lobe takes an interval of a coordinate, which is stretched again.

    Of 256 stratified points half go to each lobe. The matt lobe's mean height, 2/3, then scatters
    less than if each point's lobe were chosen by another random number, which leaves 128 of its
    points here and there.
    """
    both, matt = Surface((0.4,) * 3, (0.4,) * 3, 0.3), Surface((0.4,) * 3, (0.0,) * 3, 0.3)
    viewer = np.array([[0.0], [0.0], [1.0]])
    i, j = np.divmod(np.arange(256), 16)
    stretched, chosen = [], []
    for seed in range(200):
        rng = np.random.default_rng(seed)
        square = (np.stack([i, j]) + rng.random((2, 256))) / 16.0
        stretched.append(drawn(both, viewer, square)[0][2, i >= 8].mean())
        chosen.append(drawn(matt, viewer, square)[0][2, rng.permutation(256) < 128].mean())
    assert np.mean(stretched) == pytest.approx(2.0 / 3.0, abs=4.0 * np.std(stretched) / 200**0.5)
    three_sigma = 3.0 * np.sqrt(2.0 / 400.0)  # of the ratio of two deviations over 200 seeds
    assert np.std(stretched) / np.std(chosen) < 1.0 - three_sigma


def test_where_the_smooth_normal_faces_away_the_flat_one_shades() -> None:
    import mitsuba as mi

    from renders.tracing.surface_table import SurfaceSeen, SurfaceTable

    table = SurfaceTable([Surface((0.5,) * 3, (0.0,) * 3, 1.0)], {0: 0})
    up, viewer = mi.Vector3f(0.0, 0.0, 1.0), mi.Vector3f(0.995, 0.0, 0.0999)
    light = mi.Vector3f(0.0, 0.0, 1.0)

    def radiance(leaning: Any, seen_from: Any) -> float:
        args = (table, mi.UInt32(0), up, leaning, seen_from, BANDS, mi.Bool(True))
        return float(SurfaceSeen(*args).value(0, light)[0])

    away = mi.Vector3f(-0.6, 0.0, 0.8)
    assert radiance(away, mi.Vector3f(0.0, 0.0, 1.0)) == pytest.approx(0.5 * 0.8 / np.pi)
    assert radiance(away, viewer) == pytest.approx(0.5 / np.pi)
    assert radiance(-away, viewer) == pytest.approx(0.5 / np.pi)  # wound the other way round


def test_the_back_of_a_one_sided_surface_is_black_and_ends_the_path() -> None:
    disc = surface_of_disc(RetroreflectorOptics())
    below = np.array([[0.0], [0.0], [-1.0]])
    assert not np.array(seen_from(disc, below).reflects).any()
    assert (value(disc, below, below) == 0.0).all()
    _, weights = drawn(disc, below, np.random.default_rng(1).random((2, 100)))
    assert (weights == 0.0).all()


@pytest.mark.parametrize("name", NAMES)
def test_the_density_from_the_other_side_is_that_of_the_surface_seen_from_there(name: str) -> None:
    surface = surface_of(MATERIALS[name])
    viewer, light = directions(1), directions(2)
    found = density_back(surface, viewer, light)
    assert found == pytest.approx(density(surface, light, viewer), rel=FLOAT32, abs=1e-6)
