"""A camera of one's own in a scenario: as typed, whole, and not told twice."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from models.camera import Camera, camera_preset
from models.errors import ScenarioError
from renders.scenario.camera_choice import camera_of, pixel_scale
from renders.scenario.camera_tables import CameraTable
from renders.scenario.scenario import RenderRequest, Scenario, read_scenario, resolve
from tests.support.own_scenario import OWN_CAMERA


def written(folder: Path, camera: dict[str, Any], **tables: Any) -> Path:
    path = folder / "mine.toml"
    path.write_text(tomli_w.dumps({"name": "mine", "camera": camera, **tables}))
    return path


def refusal(folder: Path, camera: dict[str, Any]) -> str:
    with pytest.raises(ScenarioError) as told:
        read_scenario(written(folder, camera))
    assert str(told.value).startswith(str(folder / "mine.toml"))
    return str(told.value)


def without(*keys: str, **changes: Any) -> dict[str, Any]:
    return {key: x for key, x in OWN_CAMERA.items() if key not in keys} | changes


def test_a_camera_is_as_typed(tmp_path: Path) -> None:
    scenario = read_scenario(written(tmp_path, OWN_CAMERA))
    assert scenario.simulated_camera == Camera(1920, 1200, 2210.0, 2190.0, 987.3, 571.8, k1=-0.22)


def test_what_is_typed_in_pixels_is_meant_for_its_own_pixels(tmp_path: Path) -> None:
    tables = {"detector": {"pixel_pitch_um": 3.45}, "optics": {"psf_sigma_px": 0.7}}
    scenario = read_scenario(written(tmp_path, OWN_CAMERA, **tables))
    assert scenario.pixel_scale == 1.0
    assert scenario.simulated_detector.pixel_pitch_um == 3.45
    assert scenario.simulated_optics.psf_sigma_px == 0.7
    assert scenario.simulated_optics.veiling_glare_px == scenario.optics.veiling_glare_px


def test_pixels_are_square_and_the_middle_is_the_middle_where_nothing_is_said(
    tmp_path: Path,
) -> None:
    camera = read_scenario(written(tmp_path, without("fy", "cx", "cy", "k1"))).simulated_camera
    assert camera == Camera(1920, 1200, 2210.0, 2210.0, 959.5, 599.5)


def test_a_field_of_view_stands_for_the_intrinsics(tmp_path: Path) -> None:
    typed = {"width": 1920, "height": 1200, "fov_deg": 40.0, "k1": -0.1}
    camera = read_scenario(written(tmp_path, typed)).simulated_camera
    assert camera == replace(Camera.from_fov(1920, 1200, 40.0), k1=-0.1)
    left, right = camera.normalise([[-0.5, 599.5], [1919.5, 599.5]])[:, 0]
    ideal = replace(camera, k1=0.0).normalise([[-0.5, 599.5], [1919.5, 599.5]])[:, 0]
    assert np.rad2deg(np.arctan(ideal[1]) - np.arctan(ideal[0])) == pytest.approx(40.0)
    assert right == pytest.approx(-left)


def test_width_makes_its_pixels_larger_and_nothing_else(tmp_path: Path) -> None:
    path = written(tmp_path, OWN_CAMERA, detector={"pixel_pitch_um": 3.45})
    request = RenderRequest(str(path), Path("unused"))
    whole, quarter = resolve(request), resolve(replace(request, width=480))
    assert quarter.simulated_camera == whole.simulated_camera.resized(480)
    assert quarter.simulated_detector.pixel_pitch_um == pytest.approx(4.0 * 3.45)
    assert quarter.simulated_optics.psf_sigma_px == 0.25 * whole.simulated_optics.psf_sigma_px
    corners = np.array([[-0.5, -0.5], [479.5, 299.5]])
    np.testing.assert_allclose(
        quarter.simulated_camera.rays(corners),
        whole.simulated_camera.rays(4.0 * (corners + 0.5) - 0.5),
        rtol=1e-12,
    )
    again = tmp_path / "again.toml"
    again.write_text(quarter.to_toml())
    assert read_scenario(again) == quarter


def test_a_width_that_cannot_be_is_refused_as_the_option(tmp_path: Path) -> None:
    request = RenderRequest(str(written(tmp_path, OWN_CAMERA)), Path("unused"), width=10)
    with pytest.raises(ScenarioError, match="expected --width from 64 to 8192"):
        resolve(request)


def test_a_camera_file_lies_beside_the_scenario(tmp_path: Path) -> None:
    own = Camera(1920, 1200, 2210.0, 2190.0, 987.3, 571.8, k1=-0.22, p2=1e-4)
    (tmp_path / "lens.toml").write_text(own.to_toml())
    scenario = read_scenario(written(tmp_path, {"file": "lens.toml"}))
    assert scenario.simulated_camera == own
    assert "lens.toml" not in scenario.to_toml()
    smaller = read_scenario(written(tmp_path, {"file": "lens.toml", "rendered_width": 480}))
    assert smaller.simulated_camera == own.resized(480)


@pytest.mark.parametrize(
    ("camera", "said"),
    [
        ({"preset": "chaser_fixed", "fx": 2000.0}, "preset or a camera of your own"),
        ({"preset": "chaser_fixed", "fov_deg": 40.0}, "preset = 'chaser_fixed' and fov_deg"),
        (without(fov_deg=40.0), "say the same twice"),
        (without("fx", "fy", fov_deg=40.0), "fov_deg and cx, cy"),
        (without("fx"), "expected camera.fx in px, or camera.fov_deg"),
        (without("width"), "without width"),
        (without("height"), "without height"),
        ({"rendered_width": 480}, "without width and height"),
        (without(fx=0.0), "expected camera.fx from 1 to 1e+06"),
        (without(height=1200.5), "expected camera.height to be a whole number"),
        (without(k1=-3.0), "is one-to-one"),
        ({"file": "absent.toml"}, "absent.toml"),
        ({"file": "absent.toml", "fx": 2000.0}, "camera.file alone"),
    ],
)
def test_a_camera_told_twice_or_not_whole_is_refused(
    tmp_path: Path, camera: dict[str, Any], said: str
) -> None:
    with pytest.raises(ScenarioError) as told:
        read_scenario(written(tmp_path, camera))
    assert said in str(told.value)


def test_a_preset_is_what_it_was() -> None:
    """No key of a camera of one's own stands in a scenario that types none."""
    for width in (333, 2048):
        scenario = Scenario.model_validate({"name": "x", "camera": {"width": width, "k2": 0.01}})
        expected = replace(camera_preset("chaser_fixed").resized(width), k2=0.01)
        assert scenario.simulated_camera == expected
        assert scenario.pixel_scale == width / 2048
        text = scenario.to_toml()
        assert 'preset = "chaser_fixed"' in text
        for key in ("fx", "height", "rendered_width", "fov_deg", "kind", "table", "told"):
            assert f"\n{key} = " not in text
            assert f"[{key}]" not in text


def test_a_file_has_no_place_in_a_scenario_that_has_none() -> None:
    from renders.scenario.scenario import check_scenario

    scenario = Scenario.model_validate({"name": "x", "camera": {"file": "lens.toml"}})
    with pytest.raises(ScenarioError, match=r"camera\.file of a scenario that is read from a file"):
        check_scenario(scenario, "here")


def test_a_preset_has_its_own_columns_unless_they_are_typed() -> None:
    """VINAG's camera: 1920 x 1080, +-50 deg; half of it at 960 columns."""
    whole = CameraTable.model_validate({"preset": "vinag_1080p"})
    camera = camera_of(whole)
    assert (camera.width, camera.height) == (1920, 1080)
    assert np.rad2deg(np.arctan(0.5 * camera.width / camera.fx)) == pytest.approx(50.0)
    assert pixel_scale(whole) == 1.0
    half = camera_of(CameraTable.model_validate({"preset": "vinag_1080p", "width": 960}))
    assert (half.width, half.height) == (960, 540)
    assert camera_of(CameraTable.model_validate({"preset": "eye_in_hand"})).width == 2048
