"""Lost in space: who is identified, how well, and who is rightly refused."""

import numpy as np
import pytest

from bench.suites.vinag2018.star_bound import attitude_bound
from bench.suites.vinag2018.star_survey import SKIES, Sky
from pipelines.star_attitude.options import StarAttitudeOptions
from pipelines.star_attitude.star_sensor import StarSensor
from renders.star_images.star_frame import mean_charge
from tests.support.star_frames import SMALL, frame_of, off_arcsec, starless

SENSOR = StarSensor(SMALL)
ATTITUDES = 24
EMPTY, HARD = SKIES["nothing in the way"], SKIES["20 false stars and the Moon"]
WRONG_ARCSEC = 100.0
NOISE_E = SMALL.detector.bias_dn + np.random.default_rng(0).normal(0.0, 5.0, (512, 512))


@pytest.fixture(scope="module")
def clear():
    """Frames with nothing in the way, and what the sensor makes of them."""
    found = []
    for number in range(ATTITUDES):
        view, image = frame_of(EMPTY, number)
        found.append((view, SENSOR.find(image, view.rate_in_cam_rad_s, view.velocity_m_s)))
    return found


def test_every_attitude_is_identified_and_none_is_wrong(clear):
    """24 of 24 come by luck from a sensor of 99 % in 4 of 5 times; the suite has a thousand."""
    assert all(bool(fix) for _, fix in clear)
    assert all(np.linalg.norm(off_arcsec(fix, view)) < WRONG_ARCSEC for view, fix in clear)


def test_errors_are_near_the_bound_and_honest(clear):
    """48 squared errors across: their mean is known to 20 %, its root to 10 %."""
    errors = np.array([off_arcsec(fix, view) for view, fix in clear])
    bounds = np.array(
        [
            np.diag(attitude_bound(view, mean_charge(view, SMALL), SMALL, SENSOR.catalogue))
            for view, _ in clear
        ]
    )
    least = np.rad2deg(np.sqrt(bounds[:, :2].mean())) * 3600.0
    across = np.sqrt(np.mean(errors[:, :2] ** 2))
    assert 0.75 < across / least < 1.35
    stated = np.array([fix.covariance_rad2 for _, fix in clear])
    off = np.deg2rad(errors / 3600.0)
    squares = np.einsum("ni,ni->n", off, np.linalg.solve(stated, off[..., None])[..., 0])
    assert 0.5 < squares.mean() / 3.0 < 1.6


def test_the_boresight_is_known_better_than_the_turn_about_it(clear):
    stated = np.array([np.diag(fix.covariance_rad2) for _, fix in clear])
    assert (stated[:, 2] > 9.0 * stated[:, :2].max(axis=1)).all()


def test_false_stars_and_the_moon_do_not_mislead():
    """12 frames, 20 false stars each, brighter than most: none is wrong, none identified as one."""
    for number in range(12):
        view, image = frame_of(HARD, number)
        fix = SENSOR.find(image, view.rate_in_cam_rad_s, view.velocity_m_s)
        assert fix, fix.reason
        assert np.linalg.norm(off_arcsec(fix, view)) < WRONG_ARCSEC
        own = fix.spots.pixels[fix.identified[:, 0]]
        apart = np.linalg.norm(own[:, None] - view.false_px, axis=2).min(axis=1)
        assert np.mean(apart < 1.0) < 0.1  # a false star may hit a true one


def test_without_the_velocity_aberration_is_the_error():
    """Told nothing of the Earth's 30 km/s the camera is off by some 20 arcsec, not lost."""
    view, image = frame_of(Sky(rate_deg_s=0.0), 2)
    told, untold = SENSOR.find(image, velocity_m_s=view.velocity_m_s), SENSOR.find(image)
    assert np.linalg.norm(off_arcsec(told, view)[:2]) < 4.0
    in_cam = view.cam_from_icrs @ view.velocity_m_s
    expected = np.hypot(in_cam[0], in_cam[1]) / 2.998e8 * 206265.0
    assert np.linalg.norm(off_arcsec(untold, view)[:2]) == pytest.approx(expected, abs=4.0)


def test_identified_numbers_are_the_stars_own(clear):
    """Each star named projects to within a pixel of the spot that bears its name."""
    from models.sky.aberration import aberrated
    from models.sky.hipparcos import hipparcos_stars

    stars = hipparcos_stars()
    row = {number: place for place, number in enumerate(stars.numbers.tolist())}
    for view, fix in clear[:6]:
        known = stars.directions_in_icrs[[row[each] for each in fix.identified[:, 1].tolist()]]
        seen = SMALL.camera.project(aberrated(known, view.velocity_m_s) @ view.cam_from_icrs.T)
        off = np.linalg.norm(fix.spots.pixels[fix.identified[:, 0]] - seen, axis=1)
        assert off.max() < 1.0


@pytest.mark.parametrize(
    ("image", "reason"),
    [
        (np.zeros((512, 512), np.uint16), "0 spots look like stars, at least 4"),
        (np.full((512, 512), 65535, np.uint16), "100 % of the image is saturated, at most 25 %"),
        (np.clip(NOISE_E, 0, 16383).astype(np.uint16), "spots look like stars, at least 4"),
        (np.zeros((100, 200), np.uint16), "expected an image of 512 x 512 px, got 100 x 200"),
        (np.tile(np.arange(512, dtype=np.uint16) * 30, (512, 1)), "spots look like stars"),
    ],
    ids=["black", "white", "noise", "another size", "a ramp"],
)
def test_what_shows_no_stars_is_refused_with_its_reason(image, reason):
    fix = SENSOR.find(image)
    assert not fix
    assert fix.cam_from_icrs is None
    assert fix.covariance_rad2 is None
    assert reason in fix.reason


def test_random_numbers_of_full_range_are_refused():
    image = np.random.default_rng(3).integers(0, 16384, (512, 512)).astype(np.uint16)
    assert SENSOR.find(image).cam_from_icrs is None


@pytest.mark.parametrize("seed", range(3))
def test_skies_of_false_stars_alone_are_refused(seed):
    """Three skies of strangers, 12 to 30 each: never an attitude, whatever fits by chance."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(12, 31))
    view, _ = frame_of(EMPTY, 0)
    image = starless(view, rng.uniform(5.0, 506.0, (count, 2)), rng.uniform(2.0, 5.5, count))
    fix = SENSOR.find(image)
    assert not fix
    assert "agree with no part of the sky" in fix.reason
    assert fix.triangles > 100


def test_another_part_of_the_sky_mirrored_is_refused():
    """A mirrored frame has every distance right, and no attitude."""
    _, image = frame_of(Sky(rate_deg_s=0.0), 1)
    fix = StarSensor(SMALL, StarAttitudeOptions(most_triangles=400)).find(image[:, ::-1].copy())
    assert not fix
