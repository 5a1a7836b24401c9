"""Stars behind a free target: the orbit alone says where, and its inertial axes are the ICRS."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from models.arrays import Floats, Radiance
from models.lights.earth import EARTH_RADIUS_KM
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.tumble import CAM_FROM_LVLH
from models.sky.star_catalogue import bright_stars
from renders.batches.replay import exposed_frames
from renders.detector.stars import star_electrons, stars_in_view
from renders.scenario.scenario import Scenario
from renders.world.build import world_of
from renders.world.world import World
from tests.renders.conftest import TinyTumble
from tests.support.frame_images import single, stored_frames
from tests.support.tumble_scenario import TUMBLE, tumble_table

WHERE_PX = 1e-6  # rounding: the target's attitude is integrated, and cancels
SIX_SIGMA = 6.0
SHUTTER_S = 0.01
SHUTTER_RAD = 1e-6  # (0.6 deg/s for half of it), squared, and far below a pixel


def starry(**changes: object) -> World:
    table = tumble_table(stars={"shine": True}, camera={"width": 512}, earth={"shines": False})
    return world_of(Scenario.model_validate(table | changes))


def space(of: World) -> Radiance:
    return np.zeros((of.camera.height, of.camera.width), dtype=np.float32)


def cam_from_icrs(time_s: float) -> Floats:
    """Return it from the orbit's elements alone: the chaser keeps to its local frame."""
    orbit = KeplerOrbit.from_elements_deg(**TUMBLE["orbit"])
    return CAM_FROM_LVLH.rotation @ orbit.inertial_from_lvlh(time_s).T


@pytest.mark.parametrize("time_s", [0.0, 31.0, 100.0])
def test_stars_stand_where_the_orbit_alone_puts_them(time_s: float) -> None:
    of = starry()
    found, _, _ = stars_in_view(of, time_s, space(of))
    in_cam = bright_stars().directions_in_icrs @ cam_from_icrs(time_s).T
    ahead = in_cam[in_cam[:, 2] > 0.5]
    pixels = of.camera.project(ahead)
    expected = pixels[of.camera.contains(pixels)]
    assert len(expected) > 20
    np.testing.assert_allclose(found, expected, atol=WHERE_PX)


@pytest.mark.parametrize("end_s", [0.0, 100.0])
def test_a_shutter_may_be_open_over_the_motions_ends(end_s: float) -> None:
    of = starry()
    for time_s in (end_s - 0.5 * SHUTTER_S, end_s + 0.5 * SHUTTER_S):
        turned = of.trajectory.cam_from_target(time_s).rotation
        seen = turned @ of.sky.turning.target_from_icrs(time_s)
        assert np.abs(seen - cam_from_icrs(time_s)).max() < SHUTTER_RAD
    charge = star_electrons(of, end_s, 1e3 * SHUTTER_S, space(of))
    assert charge.sum() > 0.0


def test_the_earth_below_hides_stars() -> None:
    """Looking along track, its limb lies 26.8 deg below the boresight: beyond 19 deg of image."""
    low = {**TUMBLE["orbit"], "a_km": 6700.0, "e": 0.0}
    hidden, free = (
        starry(earth={"shines": shines}, tumble={**TUMBLE, "orbit": low})
        for shines in (True, False)
    )
    above, every = (stars_in_view(of, 0.0, space(of))[0] for of in (hidden, free))
    assert 0 < len(above) < len(every)
    below_deg = np.rad2deg(np.arcsin(free.camera.rays(every)[:, 1]))
    limb_deg = 90.0 - np.rad2deg(np.arcsin(EARTH_RADIUS_KM / 6700.0))
    assert (below_deg < limb_deg).sum() <= len(above)  # a cone is lower away from its middle
    assert (np.rad2deg(np.arcsin(hidden.camera.rays(above)[:, 1])) < limb_deg + 6.0).all()


def test_a_dataset_with_stars_is_replayed_and_no_star_stands_on_the_craft(
    tumbled: TinyTumble, tmp_path: Path
) -> None:
    """A fast lens, 20 ms at 64 columns."""
    frames = {}
    for shine in (False, True):
        table = tumble_table(
            stars={"shine": shine},
            earth={"shines": False},
            optics={"f_number": 1.0},
            exposure={"mode": "fixed", "exposure_ms": 20.0 * 32**2},
        )
        case, out = tmp_path / f"{shine}.toml", tmp_path / f"{shine}"
        case.write_text(Scenario.model_validate(table).to_toml())
        TinyTumble(replace(tumbled.request, case=str(case), out=out)).render()
        frames[shine] = [single(frame).astype(int) for frame in stored_frames(out)]
        for ours, theirs in zip(exposed_frames(out, run=0)[1], frames[shine], strict=True):
            np.testing.assert_array_equal(single(ours), theirs)
    shown, detector = 0, tumbled.world.scenario.simulated_detector
    for number, (without, within) in enumerate(zip(*frames.values(), strict=True)):
        labels = cv2.imread(str(out / f"truth/labels/{number:06d}.png"), cv2.IMREAD_UNCHANGED)
        noise_dn = np.sqrt(2.0) * detector.noise_dn(without.astype(float))
        brighter = within - without > SIX_SIGMA * noise_dn
        assert (labels[brighter] == 0).all()
        shown += int(brighter.sum())
    assert shown > 0
