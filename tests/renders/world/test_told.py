"""What a pipeline is told: true, plus a stated offset, plus a draw whose sigma it knows."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.camera import Camera
from models.dataset.frame_table import FrameEntry
from models.dataset.onboard_files import onboard_texts, read_onboard
from models.errors import ScenarioError
from models.frame import TableReading
from models.markers import MarkerPattern
from models.motion.tumble import CAM_FROM_LVLH
from models.onboard import FlightExpectations, OnboardKnowledge
from models.sensors.camera_chip import Detector
from models.spacecraft.wireframes import wireframe_by_name
from renders.scenario.told_tables import CalibrationTable, ToldTable
from renders.world.told import EXACT_CLOCK, SAID_OF, ToldClock, quantities, told
from tests.support.own_scenario import OWN_CAMERA, OWN_MARKERS, every_difference

EXACT = CalibrationTable()  # type: ignore[call-arg]
MARKERS = MarkerPattern(
    tuple(row["name"] for row in OWN_MARKERS["marker"]),
    np.array([row["point_in_target_m"] for row in OWN_MARKERS["marker"]]),
    np.array([row["normal_in_target"] for row in OWN_MARKERS["marker"]]),
    OWN_MARKERS["radius_m"],
)
INERTIA = np.array([[7052.0, -820.0, -3991.0], [-820.0, 129129.0, 0.0], [-3991.0, 0.0, 131196.0]])
TRUE = OnboardKnowledge(
    camera=Camera(**OWN_CAMERA),
    detector=Detector(),
    markers=MARKERS,
    wireframe=wireframe_by_name("xmm"),
    expectations=FlightExpectations(CAM_FROM_LVLH, sigma_px=1.0, inertia_kg_m2=INERTIA),
    psf_sigma_px=0.7,
)
RUNS = 400
SCATTER = 5.0 / np.sqrt(2.0 * RUNS)  # of a sample's sigma, relative: five of its own sigmas


def table(**tables: Any) -> ToldTable:
    return ToldTable.model_validate(tables)


def told_of(run: int = 0, **tables: Any) -> OnboardKnowledge:
    return told(TRUE, table(**tables), EXACT, run)


def numbers_of(onboard: OnboardKnowledge) -> dict[str, np.ndarray]:
    """Return every number that is told, by quantity."""
    assert onboard.markers is not None
    assert onboard.wireframe is not None
    assert onboard.expectations is not None
    camera = {name: np.array(x) for name, x in asdict(onboard.camera).items()}
    detector = onboard.detector
    return {
        **camera,
        "gain": np.array([detector.gain_e_dn, detector.bias_dn, detector.read_noise_e]),
        "places": onboard.markers.points_in_target,
        "normals": onboard.markers.normals_in_target,
        "radius": np.array(onboard.markers.radius_m),
        "corners": onboard.wireframe.points_in_target,
        "mount": onboard.expectations.cam_from_lvlh.matrix(),
        "inertia": np.asarray(onboard.expectations.inertia_kg_m2),
        "psf": np.array(onboard.psf_sigma_px or 0.0),
    }


# Nothing told otherwise


def test_without_a_table_all_is_told_as_it_is_but_the_blur() -> None:
    plain = told(TRUE, None, EXACT, 3)
    expected = numbers_of(TRUE) | {"psf": np.array(0.0)}
    for key, numbers in numbers_of(plain).items():
        np.testing.assert_array_equal(numbers, expected[key])
    assert plain.psf_sigma_px is None
    assert onboard_texts(plain).keys().isdisjoint({"sigmas.toml", "optics.toml"})


def test_an_empty_table_changes_no_bit() -> None:
    plain, empty = told(TRUE, None, EXACT, 3), told_of(3)
    for key, numbers in numbers_of(plain).items():
        np.testing.assert_array_equal(numbers_of(empty)[key], numbers)
    assert empty.sigmas == {}


def test_the_calibration_draws_as_it_always_did() -> None:
    """Its four numbers come from one generator of the run, focal lengths first."""
    calibration = CalibrationTable(sigma_focal_px=2.0, sigma_principal_point_px=0.5)
    draw = np.random.default_rng([7, 102]).standard_normal(4)
    expected = replace(
        TRUE.camera,
        fx=2210.0 + 2.0 * draw[0],
        fy=2190.0 + 2.0 * draw[1],
        cx=987.3 + 0.5 * draw[2],
        cy=571.8 + 0.5 * draw[3],
    )
    plain = told(TRUE, None, calibration, 7)
    assert plain.camera == expected
    assert plain.sigmas == {}  # nobody was told of them before there was a [told]
    beside = told(TRUE, table(camera={"k1": {"sigma": 0.01}}), calibration, 7)
    assert replace(beside.camera, k1=-0.22) == expected
    assert beside.sigmas == {
        "camera.fx": 2.0,
        "camera.fy": 2.0,
        "camera.cx": 0.5,
        "camera.cy": 0.5,
        "camera.k1": 0.01,
    }


def test_two_errors_of_one_number_add_in_squares() -> None:
    calibration = CalibrationTable(sigma_focal_px=3.0)  # type: ignore[call-arg]
    onboard = told(TRUE, table(camera={"fx": {"sigma": 4.0}}), calibration, 0)
    assert onboard.sigmas == {"camera.fx": 5.0, "camera.fy": 3.0}


# Offsets and draws


def test_an_offset_is_told_to_nobody() -> None:
    onboard = told_of(camera={"fx": {"offset": 3.0}}, detector={"gain_e_dn": {"offset": -1.0}})
    assert onboard.camera == replace(TRUE.camera, fx=2213.0)
    assert onboard.detector == replace(TRUE.detector, gain_e_dn=25.0)
    assert onboard.sigmas == {}


def test_a_draw_has_its_sigma_about_its_offset_and_another_in_every_run() -> None:
    said = {"fx": {"offset": 3.0, "sigma": 2.0}}
    draws = np.array([told_of(run, camera=said).camera.fx for run in range(RUNS)]) - 2210.0
    assert abs(draws.mean() - 3.0) < 5.0 * 2.0 / np.sqrt(RUNS)
    assert abs(draws.std() / 2.0 - 1.0) < SCATTER
    assert len(set(draws)) == RUNS
    assert told_of(5, camera=said).camera.fx - 2210.0 == draws[5]


@given(run=st.integers(0, 1000))
def test_adding_a_quantity_changes_no_other(run: int) -> None:
    one = {"markers": {"place_m": {"sigma": 0.001}}, "camera": {"fx": {"sigma": 1.0}}}
    alone, beside = told_of(run, **one), told_of(run, **{**every_difference(), **one})
    assert alone.markers is not None
    assert beside.markers is not None
    np.testing.assert_array_equal(alone.markers.points_in_target, beside.markers.points_in_target)
    assert beside.camera == alone.camera


def test_each_quantity_moves_its_own_number_and_says_its_sigma() -> None:
    """One key of [told] at a time: what moves is one of the numbers, and one sigma is told."""
    plain, whole = numbers_of(told_of()), every_difference()
    moved_by: dict[str, set[str]] = {}
    for name, key, _ in quantities(table(**whole)):
        onboard = told_of(2, **{name: {key: whole[name][key]}})
        moved = {k for k, x in numbers_of(onboard).items() if not np.array_equal(x, plain[k])}
        moved_by[f"{name}.{key}"] = moved
        assert onboard.sigmas == {SAID_OF.get(f"{name}.{key}", f"{name}.{key}"): 0.002}
    clock = {key: moved_by.pop(key) for key in ("clock.offset_s", "clock.drift_ppm")}
    assert set(map(len, moved_by.values())) == {1}, moved_by
    assert not any(clock.values())  # times are told elsewhere
    assert {next(iter(moved)) for moved in moved_by.values()} >= set(plain) - {"width", "height"}


def test_a_reader_of_the_files_gets_what_was_told(tmp_path: Any) -> None:
    onboard = told_of(1, **every_difference())
    texts = onboard_texts(onboard)
    assert {"sigmas.toml", "optics.toml"} <= texts.keys()
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    again = read_onboard(tmp_path, tuple(texts))
    assert again.sigmas == onboard.sigmas
    for key, numbers in numbers_of(onboard).items():
        np.testing.assert_allclose(numbers_of(again)[key], numbers, rtol=1e-12, atol=1e-12)


# What each means


def test_each_marker_has_a_place_of_its_own() -> None:
    onboard = told_of(markers={"place_m": {"offset": [0.0, 0.0, 0.01], "sigma": 0.001}})
    assert onboard.markers is not None
    errors = onboard.markers.points_in_target - MARKERS.points_in_target
    assert len(np.unique(errors)) == errors.size
    np.testing.assert_allclose(errors.mean(axis=0), [0.0, 0.0, 0.01], atol=5 * 0.001 / np.sqrt(5))


def test_a_marker_more_leaves_the_others_where_they_were_told() -> None:
    fewer = replace(TRUE, markers=MarkerPattern(
        MARKERS.names[:4], MARKERS.points_in_target[:4], MARKERS.normals_in_target[:4], 0.02
    ))  # fmt: skip
    said = table(markers={"place_m": {"sigma": 0.001}})
    some, all_of_them = told(fewer, said, EXACT, 0).markers, told(TRUE, said, EXACT, 0).markers
    assert some is not None
    assert all_of_them is not None
    np.testing.assert_array_equal(some.points_in_target, all_of_them.points_in_target[:4])


def test_normals_tilt_by_the_angle_said() -> None:
    onboard = told_of(markers={"normal_deg": {"offset": [3.0, 0.0, 0.0]}})
    assert onboard.markers is not None
    tilted = np.array([0.0, -np.sin(np.deg2rad(3.0)), np.cos(np.deg2rad(3.0))])
    np.testing.assert_allclose(
        onboard.markers.normals_in_target, np.tile(tilted, (5, 1)), atol=1e-12
    )


def test_a_centre_of_mass_told_too_far_along_x_moves_the_drawing_back() -> None:
    onboard = told_of(target={"centre_of_mass_m": {"offset": [0.1, 0.0, 0.0]}})
    assert onboard.wireframe is not None
    assert TRUE.wireframe is not None
    for name in ("points_in_target", "triangles_in_target"):
        error = getattr(onboard.wireframe, name) - getattr(TRUE.wireframe, name)
        np.testing.assert_allclose(
            error, np.broadcast_to([-0.1, 0.0, 0.0], error.shape), atol=1e-12
        )


def test_an_inertia_keeps_its_shape_when_scaled_and_its_moments_when_turned() -> None:
    def inertia(**target: Any) -> np.ndarray:
        expected = told_of(target=target).expectations
        assert expected is not None
        assert expected.inertia_kg_m2 is not None
        return expected.inertia_kg_m2

    np.testing.assert_allclose(inertia(inertia_scale={"offset": 0.1}), 1.1 * INERTIA, rtol=1e-12)
    turned = inertia(inertia_axes_deg={"offset": [0.0, 0.0, 5.0]})
    np.testing.assert_allclose(np.linalg.eigvalsh(turned), np.linalg.eigvalsh(INERTIA), rtol=1e-9)
    axis = Rotation.from_euler("z", 5.0, degrees=True).as_matrix()
    np.testing.assert_allclose(turned, axis @ INERTIA @ axis.T, rtol=1e-9, atol=1e-6)


def test_a_mount_turns_and_shifts_in_the_cameras_axes() -> None:
    said = {"turn_deg": {"offset": [0.0, 0.5, 0.0]}, "place_m": {"offset": [0.02, 0.0, 0.0]}}
    expected = told_of(mount=said).expectations
    assert expected is not None
    turn = Rotation.from_matrix(expected.cam_from_lvlh.rotation @ CAM_FROM_LVLH.rotation.T)
    np.testing.assert_allclose(turn.as_rotvec(degrees=True), [0.0, 0.5, 0.0], atol=1e-9)
    np.testing.assert_allclose(expected.cam_from_lvlh.translation, [0.02, 0.0, 0.0], atol=1e-12)


def test_a_blur_is_told_where_its_table_is() -> None:
    assert told_of(optics={}).psf_sigma_px == 0.7
    assert told_of(optics={"psf_sigma_px": {"offset": 0.1}}).psf_sigma_px == pytest.approx(0.8)


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ({"camera": {"fx": {"offset": -3000.0}}}, "fx in px above zero"),
        ({"camera": {"k1": {"offset": -5.0}}}, "one-to-one"),
        ({"detector": {"gain_e_dn": {"offset": -30.0}}}, "a gain of -4 e/DN"),
        ({"detector": {"bias_dn": {"offset": 5000.0}}}, "at least 10 DN between bias"),
        ({"optics": {"psf_sigma_px": {"offset": -1.0}}}, "a blur of -0.3 px"),
        ({"markers": {"radius_m": {"offset": -0.1}}}, "a radius in m above zero"),
        ({"target": {"inertia_scale": {"offset": -1.5}}}, "an inertia of -0.5 times"),
    ],
)
def test_what_cannot_be_is_told_to_nobody(tables: dict[str, Any], said: str) -> None:
    with pytest.raises(ScenarioError, match="in run 4") as told_error:
        told_of(4, **tables)
    assert said in str(told_error.value)


# Clocks


def test_an_exact_clock_changes_no_bit() -> None:
    assert ToldClock.of(None, 0) == ToldClock.of(table(), 0) == EXACT_CLOCK
    assert EXACT_CLOCK.shows(0.1 + 0.2) == 0.1 + 0.2


def test_a_clock_is_off_and_drifts() -> None:
    clock = ToldClock.of(
        table(clock={"offset_s": {"offset": 0.5}, "drift_ppm": {"offset": 20.0}}), 0
    )
    assert clock.shows(0.0) == 0.5
    assert clock.shows(1000.0) == pytest.approx(1000.52, abs=1e-9)
    assert clock.stamped(FrameEntry(3, 1000.0, 2.0)) == FrameEntry(3, clock.shows(1000.0), 2.0)
    rows = TableReading(("x_m",), np.array([0.0, 1000.0]), np.zeros((2, 1)))
    assert clock.stamped_rows(rows).time_s.tolist() == [0.5, clock.shows(1000.0)]


def test_every_run_has_a_clock_of_its_own() -> None:
    said = table(clock={"offset_s": {"sigma": 0.1}})
    assert len({ToldClock.of(said, run).offset_s for run in range(20)}) == 20


def test_a_clock_that_no_clock_is_is_refused() -> None:
    with pytest.raises(ScenarioError, match="drift_ppm"):
        ToldClock.of(table(clock={"drift_ppm": {"offset": -2e5}}), 0)


# The Sun on board


def test_the_sun_is_told_off_by_its_sigma_and_the_sigma_with_it() -> None:
    """Across the true direction there are two axes; along it a turn changes nothing."""
    sun, sigma_deg = np.array([0.6, 0.0, 0.8]), 0.3
    assert TRUE.expectations is not None
    expected = replace(TRUE.expectations, sun_dir_in_inertial=sun, sun_sigma_deg=sigma_deg)
    onboard = replace(TRUE, expectations=expected)
    off_deg = []
    for run in range(RUNS):
        known = told(onboard, None, EXACT, run).expectations
        assert known is not None
        assert known.sun_sigma_deg == sigma_deg
        assert known.sun_dir_in_inertial is not None
        cosine = np.clip(known.sun_dir_in_inertial @ sun, -1.0, 1.0)
        off_deg.append(np.rad2deg(np.arccos(cosine)))
    mean_square = np.mean(np.square(off_deg)) / 2.0
    assert np.sqrt(mean_square) == pytest.approx(sigma_deg, rel=SCATTER)


def test_of_a_run_the_sun_is_the_same_with_other_errors_or_without() -> None:
    assert TRUE.expectations is not None
    expected = replace(
        TRUE.expectations, sun_dir_in_inertial=np.array([1.0, 0.0, 0.0]), sun_sigma_deg=1.0
    )
    onboard = replace(TRUE, expectations=expected)
    plain = told(onboard, None, EXACT, 4).expectations
    other = told(onboard, table(mount={"turn_deg": {"sigma": 0.1}}), EXACT, 4).expectations
    assert plain is not None
    assert other is not None
    np.testing.assert_array_equal(plain.sun_dir_in_inertial, other.sun_dir_in_inertial)
