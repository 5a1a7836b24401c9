"""Scenarios of two orbits: what is refused, where Sun and Earth stand, and that frames follow."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.errors import ScenarioError
from models.motion.approach import Approach
from models.motion.two_orbits import TwoOrbits
from models.sky.sun_ephemeris import epoch_of
from renders.scenario.scenario import RenderRequest, Scenario, check_scenario, resolve
from renders.world.build import world_of
from renders.world.world import World

EPOCH = "2026-06-21T06:00:00Z"
ANOMALY_DEG = 50.0
ALMANAC_DEG = 0.015  # of the house's Sun, see its own test
START = Approach()._start_state
ORBITS: dict[str, Any] = {
    "target": {"a_km": 42164.0, "true_anomaly_deg": ANOMALY_DEG},
    "chaser_from_target_m": START[:3].tolist(),
    "chaser_from_target_m_s": START[3:].tolist(),
    "degree": 4,
}


def scenario(orbits: dict[str, Any] | None = None, **tables: Any) -> Scenario:
    table: dict[str, Any] = {
        "name": "mine",
        "motion": {"epoch_utc": EPOCH, "target_wobble": False},
        "sun": {"default": "epoch"},
        "orbits": ORBITS if orbits is None else orbits,
    }
    return check_scenario(Scenario(**(table | tables)), "mine.toml")


def world(**tables: Any) -> World:
    return world_of(scenario(**tables))


def test_the_case_of_two_orbits_is_the_approach_but_for_what_pushes() -> None:
    flown = world_of(resolve(RenderRequest("maxar-orbits", Path("unused"))))
    plain = world_of(resolve(RenderRequest("maxar-approach", Path("unused"))))
    flown.check_poses()
    # Until 200 s the aim has not moved by more than the ellipse's curvature, 40 mm.
    one, other = (each.trajectory.cam_from_target(100.0) for each in (flown, plain))
    assert np.linalg.norm(one.translation - other.translation) < 0.1


def test_the_sun_stands_where_an_independent_ephemeris_has_it() -> None:
    """``beyond`` has Vallado's algorithm 29; the target's axes here are by hand."""
    dates = pytest.importorskip("beyond.dates")
    bodies = pytest.importorskip("beyond.env.solarsystem")
    epoch = epoch_of(EPOCH)
    day = dates.Date(epoch.year, epoch.month, epoch.day, epoch.hour)
    sun = np.asarray(bodies.get_body("Sun").propagate(day).copy(frame="EME2000"))[:3]
    angle = np.deg2rad(ANOMALY_DEG)  # on the equator, from the equinox
    radial = np.array([np.cos(angle), np.sin(angle), 0.0])
    along, normal = np.array([-np.sin(angle), np.cos(angle), 0.0]), np.array([0.0, 0.0, 1.0])
    expected = np.array([-along @ sun, -normal @ sun, radial @ sun]) / np.linalg.norm(sun)
    dated = world()
    found = np.array(dated.sun_at(dated.sun, 0.0).direction_in_target)
    turned = np.arctan2(np.linalg.norm(np.cross(found, expected)), found @ expected)
    assert np.rad2deg(turned) < ALMANAC_DEG


def test_the_earth_lies_below_and_the_stars_turn_over_it() -> None:
    sky = world().sky
    down, distance_km = sky.earth_at(0.0)
    np.testing.assert_allclose(down, [0.0, 0.0, -1.0], atol=1e-9)
    assert distance_km == pytest.approx(42164.0, abs=1e-3)
    first, later = (sky.turning.target_from_icrs(time_s) for time_s in (0.0, 240.0))
    turn_deg = np.rad2deg(np.arccos(0.5 * (np.trace(later @ first.T) - 1.0)))
    assert turn_deg == pytest.approx(240.0 * 360.0 / 86_164.1, rel=1e-4)  # a sidereal day


def test_a_chaser_by_elements_is_where_they_have_it() -> None:
    """A kilometre behind on the same circle: back along the track, and down by half of d^2 / a."""
    angle_deg = float(np.rad2deg(1000.0 / 42_164_000.0))
    own = {"a_km": 42164.0, "true_anomaly_deg": ANOMALY_DEG}
    behind = {"a_km": 42164.0, "true_anomaly_deg": ANOMALY_DEG - angle_deg}
    two = {"target": own, "chaser": behind, "field": "two_body"}
    flown = world(orbits=two).trajectory
    assert isinstance(flown, TwoOrbits)
    place = flown.chaser_in_orbital_target(0.0)
    np.testing.assert_allclose(place, [1000.0, 0.0, -0.5 * 1000.0**2 / 42_164_000.0], atol=1e-4)


@pytest.mark.parametrize(
    ("orbits", "tables", "told"),
    [
        ({"chaser_from_target_m": None}, {}, "got neither"),
        ({"chaser": ORBITS["target"]}, {}, "got both"),
        (
            {"chaser": ORBITS["target"], "chaser_from_target_m": None},
            {},
            "chaser_from_target_m_s with",
        ),
        ({"target": {"a_km": 42164.0, "e": 0.9}}, {}, "perigee at"),
        ({"field": "two_body"}, {}, "orbits.degree to be left out"),
        ({}, {"motion": {"target_wobble": False}}, "expected motion.epoch_utc"),
        ({}, {"motion": {"epoch_utc": EPOCH, "longitude_deg": 3.0}}, "motion.longitude_deg"),
        ({}, {"earth": {"orbit_radius_km": 7000.0}}, "earth.orbit_radius_km"),
        ({}, {"stars": {"zenith_right_ascension_deg": 3.0}}, "stars.zenith_right_ascension_deg"),
        ({}, {"motion": {"kind": "tumble", "epoch_utc": EPOCH}}, "[tumble]"),
    ],
)
def test_what_cannot_be_is_refused_with_its_key(
    orbits: dict[str, Any], tables: dict[str, Any], told: str
) -> None:
    table = {key: value for key, value in (ORBITS | orbits).items() if value is not None}
    with pytest.raises(ScenarioError) as refused:
        scenario(table, **tables)
    assert told in str(refused.value)
