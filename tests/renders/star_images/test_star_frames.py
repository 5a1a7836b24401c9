"""Star frames: where stars fall, how much of them, how motion draws them out, and other light."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.sensors.camera_chip import Radiation
from models.sky.hipparcos import hipparcos_stars
from renders.star_images.star_frame import mean_charge, star_frame
from renders.star_images.star_view import Disc, EarthView, StarView, moon_disc, sun_disc
from renders.star_images.starlight import add_starlight, stars_in_view
from tests.support.star_frames import SMALL

CAMERA = SMALL.camera
SIRIUS = hipparcos_stars().directions_in_icrs[0]
CLEAN = replace(
    SMALL,
    detector=replace(SMALL.detector, prnu=0.0, dark_current_e_s=0.0),
    hot_share=0.0,
    sky_mag_arcsec2=60.0,
    radiation=Radiation(),
)


def looking_at(direction, roll: float = 0.3, **more) -> StarView:
    """Return a view along a direction."""
    aside = np.cross([0.1, 0.2, 1.0], direction)
    aside /= np.linalg.norm(aside)
    turn = np.stack([aside, np.cross(direction, aside), direction])
    return StarView(Rotation.from_rotvec([0.0, 0.0, roll]).as_matrix() @ turn, **more)


def spread(charge: np.ndarray, middle, half: int = 12) -> tuple[float, np.ndarray, np.ndarray]:
    """Sum, mean place and covariance of the charge about a pixel."""
    u, v = np.rint(middle).astype(int)
    window = charge[v - half : v + half + 1, u - half : u + half + 1]
    rows, columns = np.mgrid[v - half : v + half + 1, u - half : u + half + 1]
    places = np.stack([columns, rows], axis=-1).reshape(-1, 2)
    weights = window.ravel() / window.sum()
    mean = weights @ places
    return float(window.sum()), mean, (places - mean).T @ ((places - mean) * weights[:, None])


def test_the_brightest_star_is_where_it_should_be_with_all_its_light():
    view = looking_at(SIRIUS)
    charge = np.zeros((CAMERA.height, CAMERA.width))
    add_starlight(charge, view, SMALL)
    light, place, _ = spread(charge, [CAMERA.cx, CAMERA.cy])
    assert light == pytest.approx(float(SMALL.electrons(hipparcos_stars().magnitude[0])), rel=1e-3)
    np.testing.assert_allclose(place, [CAMERA.cx, CAMERA.cy], atol=0.01)


def test_motion_draws_a_star_out_along_its_way_by_its_length():
    """A line's variance is its length squared over twelve; its middle stays."""
    rate = np.array([0.0, np.deg2rad(1.5), 0.0])  # about y: along the rows
    charges = []
    for own in (np.zeros(3), rate):
        charge = np.zeros((CAMERA.height, CAMERA.width))
        add_starlight(charge, looking_at(SIRIUS, rate_in_cam_rad_s=own), SMALL)
        charges.append(charge)
    still, moved = (spread(each, [CAMERA.cx, CAMERA.cy]) for each in charges)
    length = CAMERA.fx * rate[1] * SMALL.exposure_s
    grown = moved[2] - still[2]
    assert grown[0, 0] == pytest.approx(length**2 / 12.0, rel=0.02)
    assert abs(grown[1, 1]) < 0.02
    np.testing.assert_allclose(moved[1], still[1], atol=0.01)


def test_who_moves_sees_stars_nearer_to_where_he_goes():
    """At right angles to 29.8 km/s by 20.5 arcsec."""
    still = looking_at(SIRIUS)
    course = still.cam_from_icrs.T @ [1.0, 0.0, 0.0]
    moving = replace(still, velocity_m_s=29_800.0 * course)
    places = [CAMERA.project(stars_in_view(each, SMALL)[0][0]) for each in (still, moving)]
    assert places[1][0] - places[0][0] == pytest.approx(CAMERA.fx * 9.94e-5, rel=1e-3)


def test_the_chip_draws_poisson_noise_and_its_own_key():
    view = looking_at(SIRIUS)
    mean = mean_charge(view, SMALL)
    one, again, other = (star_frame(view, SMALL, (0, each, 0)) for each in (1, 1, 2))
    assert (one == again).all()
    assert (one != other).any()
    dark = mean < np.quantile(mean, 0.9)
    gain = SMALL.detector.gain_e_dn
    noise = (one.astype(float) - other.astype(float))[dark] * gain / np.sqrt(2.0)
    expected = mean[dark].mean() + SMALL.detector.read_noise_e**2 + gain**2 / 12.0
    middle = np.abs(noise) < 6.0 * np.sqrt(expected)  # without the particles' few pixels
    assert noise[middle].var() == pytest.approx(expected, rel=0.02)


def test_the_moon_burns_out_and_its_light_is_scattered_about_it():
    """Its disc is as wide as it is; the light about it falls as the lens's function does."""
    view = looking_at(SIRIUS)
    moon = Disc(view.cam_from_icrs.T @ CAMERA.rays([[200.0, 300.0]])[0], -12.0, 0.26)
    charge = mean_charge(replace(view, discs=(moon,)), CLEAN)
    full = charge > SMALL.detector.full_well_e
    assert full.sum() == pytest.approx(np.pi * (np.deg2rad(0.26) * CAMERA.fx) ** 2, rel=0.1)
    beside = charge[300, [260, 320, 440]]
    off = np.arctan2([60.0, 120.0, 240.0], CAMERA.fx)
    expected = CLEAN.scatter.scattered(np.cos(off))
    np.testing.assert_allclose(beside / beside[0], expected / expected[0], rtol=0.1)


def test_the_sun_is_kept_out_by_the_baffle():
    view = looking_at(SIRIUS)
    levels = []
    for off_deg in (20.0, 40.0):
        off = np.deg2rad(off_deg)
        sun = view.cam_from_icrs.T @ [np.sin(off), 0.0, np.cos(off)]
        levels.append(np.median(mean_charge(replace(view, discs=(sun_disc(sun),)), CLEAN)))
    assert levels[0] > SMALL.detector.full_well_e
    assert 0.0 < levels[1] < 1e-3 * levels[0]


def test_the_earth_hides_stars_and_shines():
    """Half of the field behind it, lit from behind the camera; on its night side nothing shines."""
    view = looking_at(SIRIUS)
    distance, radius = 7.158e6, 6.378137e6
    off = np.arcsin(radius / distance)
    centre = distance * view.cam_from_icrs.T @ [np.sin(off), 0.0, np.cos(off)]
    day, night = (EarthView(centre, sign * centre / distance) for sign in (-1.0, 1.0))
    lit = mean_charge(replace(view, earth=day), CLEAN)
    dark = mean_charge(replace(view, earth=night), CLEAN)
    right = lit[:, 300:]
    assert np.median(right) > SMALL.detector.full_well_e
    assert dark[:, 300:].max() < 1.0
    stars = np.zeros_like(dark)
    add_starlight(stars, view, CLEAN)
    assert dark[:, :200].max() == pytest.approx(stars[:, :200].max(), rel=1e-3)


def test_a_half_moon_is_a_tenth_of_a_full_one():
    moon = np.array([3.84e8, 0.0, 0.0])
    full, half = moon_disc(moon, np.array([-1.0, 0.0, 0.0])), moon_disc(moon, np.array([0.0, 1, 0]))
    assert full.radius_deg == pytest.approx(0.26, abs=0.01)
    assert half.magnitude - full.magnitude == pytest.approx(2.6, abs=0.2)
