"""The filter on star images, and the survey of attitudes without a prior."""

import json
from dataclasses import replace

import numpy as np
import pytest

from bench.suites.units import Outcome
from bench.suites.vinag2018.cases import GEO, LEO
from bench.suites.vinag2018.flight import flight_of
from bench.suites.vinag2018.navigation_run import NavigationTask, navigate
from bench.suites.vinag2018.plan import Plan, Sizes
from bench.suites.vinag2018.star_images import ImagedStars
from bench.suites.vinag2018.star_plan import star_options_text
from bench.suites.vinag2018.star_results import surveyed
from bench.suites.vinag2018.star_survey import SKIES, SurveyTask, survey
from bench.suites.vinag2018.star_tables import survey_table
from models.quaternions import conjugate, multiplied, to_rotation_vector
from models.sensors.star_camera import star_camera

SMOOTH = replace(LEO, degree=8)
PIXELS = 512
TASK = NavigationTask(SMOOTH, "best", "", 30.0, 0, (0,), star_rate_hz=1)


def attitude_deg(task: NavigationTask) -> tuple[float, dict]:
    values = navigate(task).values
    size = np.linalg.norm(values["attitude_rad"][5:, 0], axis=-1)
    return float(np.rad2deg(np.sqrt(np.mean(size**2)))), values


@pytest.fixture(scope="module")
def on_images():
    return attitude_deg(replace(TASK, star_pixels=PIXELS))


def test_on_images_the_filter_keeps_its_accuracy(on_images):
    """25 frames in LEO, the Earth's limb 27 deg off: no worse than by the data sheet, and honest.

    The gyroscopes, which are the same, are most of the error between frames a second apart.
    """
    by_images, values = on_images
    by_sheet, _ = attitude_deg(TASK)
    assert by_images < 1.15 * by_sheet
    assert by_images < 0.002
    assert values["unseen"].sum() == values["refused"].sum() == values["doubts"].sum() == 0
    assert values["nees_attitude"][5:].mean() / 6.0 < 2.0


def test_the_orbit_does_not_know_how_stars_were_seen(on_images):
    """Positions are those by the data sheet to a millimetre: the sensors' draws are the same."""
    _, values = on_images
    _, by_sheet = attitude_deg(TASK)
    np.testing.assert_allclose(values["position_m"], by_sheet["position_m"], atol=2e-3)


def test_a_record_is_the_attitude_with_an_honest_covariance():
    """GEO, ten frames, in body axes: 30 squares, whose mean is known to 26 %."""
    flight = flight_of(replace(GEO, degree=2), 600.0)
    stars = ImagedStars(flight, star_camera(PIXELS), (4, 0))
    squares = []
    for time_s in np.linspace(50.0, 500.0, 10).tolist():
        true = flight.attitude.quaternions(np.array([time_s]))[0]
        rate = flight.attitude.rates(np.array([time_s]))[0]
        record = stars.attitude(time_s, true, rate)
        assert record is not None
        error = to_rotation_vector(multiplied(conjugate(true), record.q_inertial_from_body_wxyz[0]))
        squares.append(error @ np.linalg.solve(record.covariance_rad2, error))
        along = np.array(stars.sensor.boresight_in_body)
        assert along @ record.covariance_rad2 @ along > 9.0 * np.trace(record.covariance_rad2) / 11
    assert 0.3 < np.mean(squares) / 3.0 < 1.9


def test_a_camera_that_sees_nothing_gives_no_record():
    """The Earth across the whole field: a refusal, and the filter goes on by its gyroscopes."""
    flight = flight_of(SMOOTH, 60.0)
    down = replace(star_camera(PIXELS), boresight_in_body=(0.0, 0.0, 1.0))
    stars = ImagedStars(flight, down, (0, 0))
    true = flight.attitude.quaternions(np.array([10.0]))[0]
    assert stars.attitude(10.0, true, np.zeros(3)) is None
    assert stars.refused == 1


def test_images_are_of_one_run():
    with pytest.raises(ValueError, match="expected one run with star images, got 2"):
        navigate(replace(TASK, star_pixels=PIXELS, runs=(0, 1)))


def test_a_survey_is_the_same_whatever_is_beside_it_and_reads_as_a_table():
    sky = SKIES["20 false stars and the Moon"]
    both = survey(SurveyTask(sky, 0, 2, 3, PIXELS, ""))
    second = survey(SurveyTask(sky, 1, 1, 3, PIXELS, ""))
    np.testing.assert_array_equal(both.values["error_rad"][1:], second.values["error_rad"])
    summary = surveyed("a sky", [both, second])
    assert summary.attitudes == 3
    assert (summary.identified, summary.wrong) == (1.0, 0)
    assert survey_table([summary]).rows[0][:3] == ["a sky, 3 attitudes", "100 %", "0"]


def test_what_is_wrong_is_counted_as_such_and_kept_out_of_the_errors():
    """Three attitudes: right, a degree off, refused."""
    values = {
        "found": np.array([True, True, False]),
        "error_rad": np.array([[1e-6, 0.0, 0.0], [0.02, 0.0, 0.0], [np.nan] * 3]),
        "stated_rad2": np.stack([1e-12 * np.eye(3)] * 3),
        "bound_rad2": np.stack([1e-12 * np.eye(3)] * 3),
        "stars": np.array([20, 5, 0]),
        "triangles": np.array([1, 2, 900]),
    }
    found = surveyed("a sky", [Outcome(values, np.array([0.1, 0.1, 0.4]))])
    assert found.identified == pytest.approx(1.0 / 3.0)
    assert found.wrong == 1
    assert found.across_over_bound == pytest.approx(np.sqrt(0.5))
    assert found.most_triangles == 900


def test_if_none_is_right_the_summary_still_writes_as_json():
    values = {
        "found": np.array([False]),
        "error_rad": np.full((1, 3), np.nan),
        "stated_rad2": np.full((1, 3, 3), np.nan),
        "bound_rad2": np.full((1, 3, 3), 1e-12),
        "stars": np.array([0]),
        "triangles": np.array([0]),
    }
    found = surveyed("a sky", [Outcome(values, np.array([0.1]))])
    assert json.loads(json.dumps(found.__dict__, allow_nan=False))["across_arcsec"] is None
    assert survey_table([found]).rows[0][3] == "–"


def test_the_part_has_surveys_and_two_flights():
    plan = Plan(Sizes(acquisitions=100, star_flights=2), ("stars",))
    names = [unit.name for unit in plan.units()]
    assert sum(name.startswith("stars/sky_0") for name in names) == 2
    assert sum("star_images" in name for name in names) == 2
    assert len(names) == len(set(names))
    assert "StarCamera" in star_options_text()
