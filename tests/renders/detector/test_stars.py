"""Stars: where they are, how much of them arrives, what hides them, and when they show."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from models.arrays import Floats, Radiance
from models.errors import ScenarioError
from models.lights.earth import EARTH_RADIUS_KM, GEO_RADIUS_KM
from models.onboard import PosePrior
from models.sky.star_catalogue import bright_stars
from renders.batches.replay import exposed_frames, read_depth
from renders.detector.compose import compose
from renders.detector.expose import SUNLIGHT_NM, electrons_per_radiance
from renders.detector.stars import (
    electrons_per_irradiance,
    star_electrons,
    stars_in_view,
)
from renders.scenario.scenario import Scenario, read_scenario
from renders.tracing.light_groups import LightGroup
from renders.world.build import world_of
from renders.world.exposure import Exposure
from renders.world.world import World
from tests.renders.conftest import TinyDataset
from tests.support.frame_images import at_800, at_850, stored_frames

CENTROID_PX = 0.02  # asked for; pixels of that size lose 0.003 px of a spread of 0.5 px
SPREAD_LOST = 1e-6  # of a star's light, beyond six sigmas
CHIP = {"prnu": 0.0}
BETELGEUSE, RIGEL = 2061, 1713
SHOWN_SIGMAS = 5.0


def world(width: int = 2048, **tables: dict[str, Any]) -> World:
    shown = {"shine": True, **tables.pop("stars", {})}
    return world_of(
        Scenario.model_validate(
            {"name": "x", "camera": {"width": width}, "detector": CHIP, "stars": shown} | tables
        )
    )


def space(of: World) -> Radiance:
    return np.zeros((of.camera.height, of.camera.width), dtype=np.float32)


def star_in_cam(of: World, number: int, time_s: float = 0.0) -> Floats:
    stars = bright_stars()
    in_target = (
        of.sky.turning.target_from_icrs(time_s)
        @ stars.directions_in_icrs[stars.numbers.index(number)]
    )
    return of.trajectory.cam_from_target(time_s).rotate(in_target)


def window(charge: Floats, pixel: Floats, reach: int = 6) -> tuple[Floats, Floats]:
    """Return the charge about a pixel, and its centroid, px."""
    u, v = np.rint(pixel).astype(int)
    cut = charge[v - reach : v + reach + 1, u - reach : u + reach + 1]
    rows, columns = np.mgrid[v - reach : v + reach + 1, u - reach : u + reach + 1]
    return cut, np.array([(cut * columns).sum(), (cut * rows).sum()]) / cut.sum()


def variance_across(cut: Floats) -> float:
    """Return the variance of a window's charge along its columns, px^2."""
    line = cut.sum(axis=0) / cut.sum()
    columns = np.arange(len(line))
    return float(line @ columns**2 - (line @ columns) ** 2)


def alone(pixels: Floats, apart_px: float = 20.0) -> Floats:
    """Return the pixels that have no other near, nor the border."""
    gaps = np.linalg.norm(pixels[:, None] - pixels[None], axis=-1) + 1e9 * np.eye(len(pixels))
    inside = ((pixels > 10.0) & (pixels < 2037.0)).all(axis=1)
    return pixels[(gaps.min(axis=1) > apart_px) & inside]


@pytest.mark.parametrize("lens", [{}, {"k1": -0.12, "k2": 0.02, "p1": 1e-3, "p2": -5e-4}])
def test_each_star_is_centred_where_its_direction_is_projected(lens: dict[str, float]) -> None:
    """The peer is OpenCV: ``projectPoints`` of far points, by camera matrix and distortion."""
    of = world(camera={"width": 2048, **lens})
    charge = star_electrons(of, 0.0, 100.0, space(of))
    stars = bright_stars()
    rotation = of.trajectory.cam_from_target(0.0).rotation @ of.sky.turning.target_from_icrs(0.0)
    ahead = stars.directions_in_icrs @ rotation[2] > np.cos(np.deg2rad(30.0))
    projected, _ = cv2.projectPoints(
        stars.directions_in_icrs[ahead][:, None] * 1e6,
        cv2.Rodrigues(rotation)[0],
        np.zeros(3),
        of.camera.matrix,
        of.camera.distortion,
    )
    pixels = projected[:, 0]
    pixels = pixels[((pixels > 0.0) & (pixels < 2047.0)).all(axis=1)]
    found = alone(pixels)
    assert len(found) > 50
    aside = [np.abs(window(charge, pixel)[1] - pixel).max() for pixel in found]
    assert max(aside) < CENTROID_PX


def test_a_stars_electrons_are_the_closed_form() -> None:
    """Pupil of 29.6 mm / 2, foreshortened; 80 % through the lens, half of it caught; 825 nm."""
    of = world(optics={"f_number": 2.0})
    in_cam = star_in_cam(of, BETELGEUSE)
    stars = bright_stars()
    irradiance = stars.irradiance_w_m2[stars.numbers.index(BETELGEUSE)]
    focal_m = 1024.0 / np.tan(np.deg2rad(25.0)) * 13.5e-6
    pupil_m2 = np.pi * (focal_m / 2.0) ** 2 / 4.0 * in_cam[2]
    photon_j = 6.62607015e-34 * 299792458.0 / 825e-9
    expected = irradiance * pupil_m2 * 0.8 * 0.5 / photon_j * 0.25
    charge = star_electrons(of, 0.0, 250.0, space(of))
    cut, _ = window(charge, of.camera.project(in_cam))
    assert cut.sum() == pytest.approx(expected, rel=10.0 * SPREAD_LOST)


@pytest.mark.parametrize("off_axis_deg", [0.0, 12.0, 30.0])
def test_a_point_and_a_radiance_of_the_same_light_give_the_same_electrons(
    off_axis_deg: float,
) -> None:
    """A radiance that fills a pixel: cos^3 of solid angle, and the chain's cos^4, leave cos."""
    of = world()
    optics, detector = of.scenario.simulated_optics, of.scenario.simulated_detector
    cosine = np.cos(np.deg2rad(off_axis_deg))
    solid_angle_sr = cosine**3 / (of.camera.fx * of.camera.fy)
    per_radiance = electrons_per_radiance(optics, detector, SUNLIGHT_NM) * cosine**4
    per_irradiance = electrons_per_irradiance(optics, of.camera, detector) * cosine
    assert per_irradiance == pytest.approx(per_radiance / solid_angle_sr, rel=1e-12)


def test_larger_pixels_hold_the_same_stars_and_the_same_light() -> None:
    fine, coarse = (star_electrons(w, 0.0, 100.0, space(w)) for w in (world(2048), world(512)))
    assert coarse.sum() == pytest.approx(fine.sum(), rel=1e-4)


def test_no_star_shines_through_what_is_in_front_of_it() -> None:
    """A disc of 300 px in front: dark within but for a spread's width, all else as before."""
    of = world()
    rows, columns = np.mgrid[0:2048, 0:2048]
    within = np.hypot(rows - 900, columns - 1000) - 300.0
    depth = np.where(within < 0.0, 3.0, 0.0).astype(np.float32)
    free, hidden = star_electrons(of, 0.0, 1e3, space(of)), star_electrons(of, 0.0, 1e3, depth)
    assert free[within < -6.0].sum() > 1e3
    assert hidden[within < -6.0].sum() == 0.0
    np.testing.assert_array_equal(hidden[within > 6.0], free[within > 6.0])


def test_no_star_stands_on_a_part_of_the_spacecraft(rendered_once: TinyDataset) -> None:
    """Labels, traced in a dataset of the Maxar-1300, and depth agree on what is space."""
    scenario = rendered_once.world.scenario
    labels_of = rendered_once.folder / "truth" / "labels"
    seen = 0
    for zenith_deg in range(0, 360, 15):
        changed = {"shine": True, "zenith_right_ascension_deg": float(zenith_deg)}
        of = world_of(Scenario.model_validate(scenario.model_dump() | {"stars": changed}))
        exposure = of.exposures[1]
        depth = read_depth(of, rendered_once.folder, exposure)
        assert depth is not None
        labels = cv2.imread(str(labels_of / "000000_850.png"), cv2.IMREAD_UNCHANGED)
        pixels, _, _ = stars_in_view(of, exposure.time_s, depth)
        every, _, _ = stars_in_view(of, exposure.time_s, np.zeros_like(depth))
        column, row = np.rint(pixels).astype(int).T
        assert (labels[row, column] == 0).all()
        assert len(every) > len(pixels)
        seen += len(pixels)
    assert seen > 0


def test_a_dataset_with_stars_is_replayed_to_the_same_bits(
    rendered_once: TinyDataset, tmp_path: Path
) -> None:
    """The light of ``tiny`` through a fast lens for 20 ms: stars beside the target, none on it."""
    frames = {}
    shutil.copytree(rendered_once.store.folder, tmp_path / "store")
    for shine in (False, True):
        table = rendered_once.world.scenario.model_dump()
        table["stars"]["shine"] = shine
        table["optics"]["f_number"] = 1.0
        table["exposure"] |= {"mode": "fixed", "exposure_ms": 20.0}
        case, out = tmp_path / f"{shine}.toml", tmp_path / f"{shine}"
        case.write_text(Scenario.model_validate(table).to_toml())
        request = replace(rendered_once.request, case=str(case), out=out, end_s=240.0)
        dataset = TinyDataset(replace(request, store=tmp_path / "store"))
        dataset.render()
        (ours,) = exposed_frames(dataset.folder, run=0)[1]
        (theirs,) = stored_frames(dataset.folder)
        np.testing.assert_array_equal(at_800(ours), at_800(theirs))
        np.testing.assert_array_equal(at_850(ours), at_850(theirs))
        frames[shine] = at_850(theirs).astype(int)
    labels = cv2.imread(str(out / "truth" / "labels" / "000000_850.png"), cv2.IMREAD_UNCHANGED)
    brighter = frames[True] - frames[False] > 20
    assert brighter.any()
    assert (labels[brighter] == 0).all()


def test_the_earth_hides_stars_if_it_is_there() -> None:
    """At GEO it is 8.7 deg in radius, and stands where the camera looks: Orion's belt is behind."""
    of, bare = world(earth={"shines": True}), world()
    limb = np.arcsin(EARTH_RADIUS_KM / GEO_RADIUS_KM)
    nadir = bare.trajectory.cam_from_target(0.0).rotate([0.0, 0.0, -1.0])
    around, _, _ = stars_in_view(of, 0.0, space(of))
    every, _, _ = stars_in_view(bare, 0.0, space(bare))
    assert (bare.camera.rays(around) @ nadir < np.cos(limb)).all()
    behind = (bare.camera.rays(every) @ nadir > np.cos(limb)).sum()
    assert len(every) - len(around) == behind > 5


def test_the_camera_of_the_approach_sees_orion_upside_down() -> None:
    """By default: the wings' southern end is up, and nothing is mirrored."""
    of = world()
    betelgeuse, rigel = (of.camera.project(star_in_cam(of, n)) for n in (BETELGEUSE, RIGEL))
    assert betelgeuse[0] > rigel[0] + 300.0
    assert betelgeuse[1] > rigel[1] + 500.0


def shown(of: World, exposure_ms: float, time_s: float = 0.0) -> Floats:
    """Return how many sigmas each star in view has in its brightest pixel, of a real exposure."""
    dark: dict[LightGroup, Radiance] = {of.sun: space(of)}
    exposure = Exposure(0, 850, time_s)
    frame = compose(of, dark, exposure, exposure_ms, 0, space(of)).astype(float)
    detector = of.scenario.simulated_detector
    level = float(np.median(frame))
    pixels, _, _ = stars_in_view(of, time_s, space(of))
    places = np.rint(pixels).astype(int)
    peaks = np.array(
        [frame[v - 1 : v + 2, u - 1 : u + 2].max() for u, v in np.clip(places, 1, 2046)]
    )
    return np.asarray((peaks - level) / detector.noise_dn(np.array(level)))


def test_in_flight_no_star_shows() -> None:
    """At f/16 the approach exposes for 1.5 ms and less: Sirius brings a dozen electrons a ms."""
    of = world()
    exact = PosePrior(of.trajectory.cam_from_target(0.0), np.zeros(3), np.zeros(3))
    longest_ms = of.plan.before_any_image(0.0, exact)
    assert 1.0 < longest_ms < 2.0
    assert shown(of, longest_ms).max() < SHOWN_SIGMAS


def test_fifty_ms_at_f16_show_but_the_brightest() -> None:
    """Betelgeuse, Sirius and Aldebaran of 99 in view: from 14 ms on, by 200 e^2 of noise."""
    assert 1 <= np.count_nonzero(shown(world(), 50.0) > SHOWN_SIGMAS) <= 5


def test_two_seconds_at_f2_show_every_star() -> None:
    of = world(optics={"f_number": 2.0})
    sigmas = shown(of, 2000.0)
    assert len(sigmas) > 90
    assert sigmas.min() > SHOWN_SIGMAS


def test_two_seconds_at_f2_show_hundreds_of_stars_around_the_sky() -> None:
    count = 0
    for zenith_deg in (0.0, 60.0, 120.0, 180.0, 240.0, 300.0):
        of = world(stars={"zenith_right_ascension_deg": zenith_deg}, optics={"f_number": 2.0})
        count += int(np.count_nonzero(star_electrons(of, 0.0, 2000.0, space(of)) > 300.0))
    assert count > 300


def test_they_are_off_unless_asked_for_and_need_depth() -> None:
    off = world_of(Scenario.model_validate({"name": "x", "camera": {"width": 128}}))
    on = world(128)
    dark: dict[LightGroup, Radiance] = {off.sun: space(off)}
    exposure = Exposure(0, 850, 0.0)
    assert not off.scenario.needs_depth
    assert on.scenario.needs_depth
    compose(off, dark, exposure, 1.0, 0)
    with pytest.raises(ScenarioError, match=r"the stars need.*stars\.shine"):
        compose(on, dark, exposure, 1.0, 0)


def test_a_moving_star_is_a_streak_as_long_as_its_way() -> None:
    """Half a turn in 20 minutes about the boresight's upright: the variance of a line, L^2 / 12."""
    rate = (0.0, 540.0, 0.0)
    tables: dict[str, Any] = {"motion": {"target_wobble": False}}
    of = world(stars={"rate_in_target_deg_h": rate}, **tables)
    still = world(stars={"rate_in_target_deg_h": (0.0, 0.0, 0.0)}, **tables)
    moving = star_electrons(of, 0.0, 100.0, space(of))
    at_rest = star_electrons(still, 0.0, 100.0, space(still))
    pixels, _, _ = stars_in_view(of, 0.0, space(of))
    start, end = (of.camera.project(star_in_cam(of, 1903, t)) for t in (-0.05, 0.05))
    length = float(np.linalg.norm(end - start))
    assert 0.4 < length < 5.0
    place = of.camera.project(star_in_cam(of, 1903))
    assert np.linalg.norm(pixels - place, axis=1).min() < 1e-9
    (long, middle), (short, centre) = window(moving, place, 8), window(at_rest, place, 8)
    added = variance_across(long) - variance_across(short)
    assert added == pytest.approx((end - start)[0] ** 2 / 12.0, abs=0.02)
    assert long.sum() == pytest.approx(short.sum(), rel=1e-3)
    assert np.abs(middle - centre).max() < CENTROID_PX


def test_a_lens_focused_near_spreads_stars_over_the_circle_of_infinity() -> None:
    """2.1 px across at f/16 and 2 m: a disc of the diameter c adds the variance c^2 / 16."""
    of, sharp = world(optics={"focus_m": 2.0}), world()
    place = of.camera.project(star_in_cam(of, BETELGEUSE))
    wide, narrow = (window(star_electrons(w, 0.0, 100.0, space(w)), place, 8) for w in (of, sharp))
    focal_m = of.camera.fx * 13.5e-6
    circle_px = focal_m**2 / 16.0 / (2.0 - focal_m) / 13.5e-6
    assert wide[0].sum() == pytest.approx(narrow[0].sum(), rel=1e-3)
    added = variance_across(wide[0]) - variance_across(narrow[0])
    assert added == pytest.approx(circle_px**2 / 16.0, rel=0.01)


def test_an_attitude_of_ones_own_is_taken_scalar_first() -> None:
    """A third of a turn about (1, 1, 1): the x of the ICRS is the target's y."""
    of = world(
        stars={"q_target_from_icrs_wxyz": (0.5, 0.5, 0.5, 0.5)}, motion={"target_wobble": False}
    )
    assert of.sky.turning.target_from_icrs(0.0) @ [1.0, 0.0, 0.0] == pytest.approx([0.0, 1.0, 0.0])


@pytest.mark.parametrize("wxyz", ["[1.0, 0.0, 0.0]", "[1.0, 1.0, 0.0, 0.0]"])
def test_an_attitude_that_is_none_is_refused(wxyz: str, tmp_path: Path) -> None:
    path = tmp_path / "sky.toml"
    path.write_text(f'name = "x"\n[stars]\nq_target_from_icrs_wxyz = {wxyz}\n')
    with pytest.raises(ScenarioError, match="q_target_from_icrs_wxyz of four numbers and length 1"):
        read_scenario(path)
