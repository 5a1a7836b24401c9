"""Particles: how many, how much charge, which way; seeds; and what a hit looks like in a frame."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from models.sensors.camera_chip import Detector, Radiation
from renders.detector.compose import compose
from renders.detector.expose import expose_electrons, exposure_rng
from renders.detector.radiation_hits import Tracks, deposit, draw_tracks, radiation_hits
from renders.scenario.scenario import Scenario
from renders.tracing.light_groups import LightGroup
from renders.world.build import world_of
from renders.world.exposure import Exposure

DETECTOR = Detector()
SHAPE = (400, 500)
QUIET = Radiation(flux_cm2_s=5.0)
AREA_CM2 = 400 * 500 * 13.5e-4**2
ONE_IN_10_000 = 1e-4


def many_tracks(count: int, radiation: Radiation = QUIET) -> Tracks:
    """Return about so many tracks, of one long exposure."""
    exposure_ms = 1e3 * count / (radiation.flux_cm2_s * AREA_CM2)
    return draw_tracks(radiation, DETECTOR, SHAPE, exposure_ms, np.random.default_rng(5))


def test_the_number_of_hits_is_poissons() -> None:
    """By chi-square over 600 exposures that expect two: flux times area times time."""
    exposure_ms = 2.0 * 1e3 / (5.0 * AREA_CM2)
    counts = [
        len(draw_tracks(QUIET, DETECTOR, SHAPE, exposure_ms, np.random.default_rng(seed)).charge_e)
        for seed in range(600)
    ]
    observed = np.bincount(np.minimum(counts, 6), minlength=7)
    expected = 600 * np.append(stats.poisson.pmf(range(6), 2.0), stats.poisson.sf(5, 2.0))
    assert stats.chisquare(observed, expected).pvalue > ONE_IN_10_000


def test_the_chip_of_the_case_is_hit_once_in_some_twenty_exposures() -> None:
    """2048 x 2048 pixels of 13.5 um are 7.6 cm2: 0.057 hits of 5 /cm2/s in 1.5 ms."""
    tracks = draw_tracks(QUIET, DETECTOR, (2048, 2048), 1.5e5, np.random.default_rng(0))
    expected = 5.0 * (2048 * 13.5e-4) ** 2 * 150.0
    assert expected == pytest.approx(5733, rel=1e-3)
    assert abs(len(tracks.charge_e) - expected) < 4.0 * np.sqrt(expected)


def test_directions_are_isotropic_and_places_even() -> None:
    """Lambert: the cosine's square is even from 0 to 1; azimuths and places are even, too."""
    tracks = many_tracks(4000)
    cosine = QUIET.depth_um * QUIET.charge_e_um / tracks.charge_e
    azimuth = np.arctan2(*tracks.run_px.T) / (2.0 * np.pi) + 0.5
    across, down = ((tracks.start_px + 0.5) / SHAPE[::-1]).T
    for even in (cosine**2, azimuth, across, down):
        assert stats.kstest(even, "uniform").pvalue > ONE_IN_10_000
    aside_um = np.linalg.norm(tracks.run_px, axis=1) * DETECTOR.pixel_pitch_um
    np.testing.assert_allclose(np.hypot(aside_um, 40.0), 40.0 / cosine, rtol=1e-9)


def test_the_mean_charge_is_twice_that_of_a_track_straight_down() -> None:
    """Cauchy's mean chord of a slab, 2 t; cut at 10 t, where its variance is finite, 1.9 t."""
    charge = many_tracks(8000).charge_e / (QUIET.depth_um * QUIET.charge_e_um)
    cut = np.minimum(charge, 10.0)
    assert charge.min() >= 1.0
    assert cut.mean() == pytest.approx(1.9, abs=4.0 * cut.std() / np.sqrt(len(cut)))


@given(
    column=st.floats(-0.49, 9.49),
    row=st.floats(-0.49, 7.49),
    across=st.floats(-30.0, 30.0),
    down=st.floats(-30.0, 30.0),
)
def test_each_pixel_gets_its_share_of_the_length(
    column: float, row: float, across: float, down: float
) -> None:
    """Against 20 thousand points along the track, those beyond the border lost."""
    shape = (8, 10)
    tracks = Tracks(np.array([[column, row]]), np.array([[across, down]]), np.array([700.0]))
    found = deposit(tracks, shape)
    steps = 20_000
    along = (np.arange(steps) + 0.5) / steps
    u, v = np.rint(column + along * across), np.rint(row + along * down)
    on = (u >= 0) & (u < 10) & (v >= 0) & (v < 8)
    expected = np.zeros(shape)
    np.add.at(expected, (v[on].astype(int), u[on].astype(int)), 700.0 / steps)
    pieces = 2.0 * 700.0 / steps  # a point more or less at either end of a pixel
    np.testing.assert_allclose(found, expected, atol=pieces)


def test_a_track_straight_down_stays_in_its_pixel() -> None:
    tracks = Tracks(np.array([[3.2, 5.4]]), np.zeros((1, 2)), np.array([4240.0]))
    found = deposit(tracks, (8, 8))
    assert found[5, 3] == 4240.0
    assert found.sum() == 4240.0


def test_charge_is_all_there_but_for_what_leaves_the_chip() -> None:
    tracks = many_tracks(300)
    inner = (np.abs(tracks.start_px + tracks.run_px - 200.0) < 150.0).all(axis=1)
    inner &= (np.abs(tracks.start_px - 200.0) < 150.0).all(axis=1)
    kept = Tracks(tracks.start_px[inner], tracks.run_px[inner], tracks.charge_e[inner])
    assert inner.sum() > 50
    assert deposit(kept, SHAPE).sum() == pytest.approx(kept.charge_e.sum(), rel=1e-12)
    assert deposit(tracks, SHAPE).sum() < tracks.charge_e.sum()


def test_the_same_exposure_has_the_same_hits_and_any_other_has_others() -> None:
    flare = replace(QUIET, flux_cm2_s=3000.0)

    def hits(*key: int) -> np.ndarray:
        found = radiation_hits(flare, DETECTOR, SHAPE, 20.0, (key[0], key[1], key[2]))
        assert found is not None
        return found

    first = hits(3, 7, 850)
    assert (first > 0.0).sum() > 20
    np.testing.assert_array_equal(first, hits(3, 7, 850))
    for other in ((4, 7, 850), (3, 8, 850), (3, 7, 800), (7, 3, 850)):
        assert not np.array_equal(first > 0.0, hits(*other) > 0.0)
    assert (
        radiation_hits(replace(QUIET, flux_cm2_s=0.0), DETECTOR, SHAPE, 20.0, (3, 7, 850)) is None
    )


def test_hits_leave_the_noise_as_it_was_and_saturate_as_light_does() -> None:
    mean, hit = np.full((40, 40), 500.0), np.zeros((40, 40))
    hit[20, 10], hit[30, 5] = 5200.0, 1e7
    plain = expose_electrons(mean, DETECTOR, exposure_rng(0, 0, 850)).astype(int)
    struck = expose_electrons(mean, DETECTOR, exposure_rng(0, 0, 850), hit).astype(int)
    assert abs(struck[20, 10] - plain[20, 10] - 200) <= 1  # 5200 e at 26 e/DN
    assert struck[30, 5] == pytest.approx(DETECTOR.saturation_dn, abs=3.0)
    assert (struck != plain).sum() == 2


def test_a_scenario_switches_them_on() -> None:
    """The same light and noise, and a few tracks more; off unless asked for."""

    def image(**table: float) -> np.ndarray:
        scenario = Scenario.model_validate(
            {"name": "x", "camera": {"width": 128}, "radiation": table}
        )
        world = world_of(scenario)
        dark: dict[LightGroup, np.ndarray] = {world.sun: np.zeros((128, 128), np.float32)}
        return compose(world, dark, Exposure(0, 850, 0.0), 30.0, run=0).astype(int)

    quiet, flare = image(), image(flux_cm2_s=300.0)
    assert Scenario(name="x").radiation.flux_cm2_s == 0.0
    more = flare - quiet
    # 7.6 cm2, 30 ms, 300 /cm2/s: 69 particles, each of 4240 e and more, 163 DN.
    assert 20 < (more > 100).sum() < 200
    assert (more >= 0).all()
    assert (more == 0).mean() > 0.95
