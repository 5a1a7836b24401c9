"""A colour chip's charge in closed form, and that each light comes in three bands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.sensors.bayer_mosaic import BANDS, filter_of_pixel
from models.sensors.camera_chip import LIGHT_SPEED_M_S, PLANCK_J_S, Detector, Optics
from renders.detector.colour import colour_rates
from renders.detector.compose import compose
from renders.scenario.case_files import case_path
from renders.scenario.scenario import Scenario, read_scenario
from renders.tracing.light_groups import LampGroup, LightGroup, SunGroup
from renders.world.build import world_of
from renders.world.exposure import FILTERED, Exposure

SIDE = 64
FLOAT32 = 1e-6


def case(**tables: dict[str, object]) -> Scenario:
    table = read_scenario(case_path("grasp-approach")).model_dump()
    table["camera"]["width"] = SIDE
    for name, values in tables.items():
        table[name].update(values)
    return Scenario(**table)


def suns() -> list[SunGroup]:
    world = world_of(case())
    groups = world.lit_by(Exposure(0, FILTERED, 290.0))
    return [group for group in groups if isinstance(group, SunGroup)]


def test_a_sun_is_seen_in_three_colours_from_one_direction() -> None:
    red, green, blue = suns()
    assert [each.channel for each in (red, green, blue)] == [0, 1, 2]
    assert red.direction_in_target == green.direction_in_target == blue.direction_in_target
    assert [each.irradiance_w_m2 for each in suns()] == [band.sun_irradiance_w_m2 for band in BANDS]
    assert len({each.name for each in suns()}) == 3


def test_an_illuminator_shares_its_power_among_the_colours() -> None:
    world = world_of(case(floodlight={"intensity_w_sr": 50.0}))
    lamps = [g for g in world.lit_by(Exposure(0, FILTERED, 290.0)) if isinstance(g, LampGroup)]
    assert len(lamps) == 3
    shares = [lamp.ring.intensity_w_sr / 50.0 for lamp in lamps]
    assert shares == pytest.approx([band.lamp_share for band in BANDS])
    assert sum(shares) < 1.0


def test_electrons_follow_the_camera_equation_in_each_band() -> None:
    optics, detector = Optics(), Detector()
    light: dict[LightGroup, np.ndarray] = {
        group: np.full((2, 2), 10.0, np.float32) for group in suns()
    }
    for band, rate in zip(BANDS, colour_rates(light, optics, detector), strict=True):
        photon_j = PLANCK_J_S * LIGHT_SPEED_M_S / (1e-9 * band.middle_nm)
        chip_w_m2 = 10.0 * optics.transmission * np.pi / (4.0 * optics.f_number**2)
        charge = chip_w_m2 * (detector.pixel_pitch_um * 1e-6) ** 2 / photon_j
        expected = charge * detector.quantum_efficiency * band.transmission
        assert rate == pytest.approx(expected, rel=FLOAT32)


@pytest.mark.parametrize("focus_m", [0.0, 0.5])
def test_each_pixel_sees_its_own_band_also_through_a_lens_with_a_focus(focus_m: float) -> None:
    scenario = case(optics={"focus_m": focus_m, "vignetting": False}, detector={"prnu": 0.0})
    world = world_of(scenario)
    exposure = Exposure(0, FILTERED, 290.0)
    levels = dict(zip((0, 1, 2), (12.0, 6.0, 3.0), strict=True))
    light: dict[LightGroup, np.ndarray] = {
        group: np.full((SIDE, SIDE), levels[group.channel], np.float32)
        for group in world.lit_by(exposure)
    }
    depth_m = np.full((SIDE, SIDE), 0.8, np.float32)
    image = compose(world, light, exposure, 0.01, 0, depth_m).astype(float)
    bands = filter_of_pixel(SIDE, SIDE)
    detector, optics = scenario.simulated_detector, scenario.simulated_optics
    for colour, rate in enumerate(colour_rates(light, optics, detector)):
        expected = detector.bias_dn + float(rate[0, 0]) * 1e-5 / detector.gain_e_dn
        mean = image[bands == colour].mean()
        noise = float(detector.noise_dn(expected)) / np.sqrt((bands == colour).sum())
        assert mean == pytest.approx(expected, abs=5.0 * noise)


def test_materials_of_the_scene_are_those_of_colour() -> None:
    world = world_of(case())
    gold = world.target.materials["mli_gold"].specular.bands
    assert gold[0] > 3.0 * gold[2]
    assert world.target.markers is not None
    assert world.target.markers.paint == "white_paint"
    assert max(world.optics.returned.bands) == 0.0  # no retroreflector shines here


def test_the_chip_on_board_is_told_its_filters() -> None:
    world = world_of(case())
    onboard = world.onboard(0)
    assert onboard.detector is not None
    assert onboard.detector.mosaic == "rggb"
    assert onboard.wireframe is not None
    assert onboard.prior is not None
    assert onboard.prior.sigma_m == pytest.approx(0.01)
    plain = replace(onboard.detector, mosaic="none")
    assert plain.noise_dn(500.0) == onboard.detector.noise_dn(500.0)
