"""Named sets of errors: what each tells, that sets share draws, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from models.errors import ScenarioError
from renders.scenario.case_files import case_path
from renders.scenario.error_sets import ALONE, ERROR_SETS, with_error_set
from renders.scenario.scenario import RenderRequest, Scenario, read_scenario, resolve
from renders.world.build import world_of


@pytest.fixture(scope="module")
def plain() -> Scenario:
    return resolve(RenderRequest("maxar-approach", Path(), width=1024))


def onboard(plain: Scenario, name: str, run: int = 3):
    return world_of(with_error_set(plain, name)).onboard(run)


def test_none_tells_everything_as_it_is(plain: Scenario) -> None:
    told, world = onboard(plain, "none"), world_of(plain)
    assert told.camera == world.camera
    assert told.detector == plain.simulated_detector
    np.testing.assert_array_equal(
        told.markers.points_in_target, world.target.markers.points_in_target
    )
    assert told.sigmas == {}


@pytest.mark.parametrize("name", [name for name in ALONE if name not in ("none", "prior", "mount")])
def test_each_error_is_told_by_its_sigma_and_is_part_of_all(plain: Scenario, name: str) -> None:
    own, every = onboard(plain, name).sigmas, onboard(plain, "realistic").sigmas
    assert own
    assert own.items() <= every.items()


def test_a_draw_is_the_same_in_every_set_that_has_it(plain: Scenario) -> None:
    one, two, three = (onboard(plain, name) for name in ("table5", "table9_c2", "table10"))
    assert one.camera == three.camera
    true = world_of(plain).camera
    assert two.camera.fx - true.fx == pytest.approx(3.0 * (one.camera.fx - true.fx))
    moved = three.markers.points_in_target - one.markers.points_in_target
    assert moved.std() == pytest.approx(1e-3, rel=0.5)  # Table 10: 30 draws of 1 mm


def test_levels_are_in_pixels_of_the_papers_width(plain: Scenario) -> None:
    full = resolve(RenderRequest("maxar-approach", Path(), width=2048))
    assert with_error_set(full, "table5").calibration.sigma_focal_px == 1.0
    assert with_error_set(plain, "table5").calibration.sigma_focal_px == 0.5


def test_the_prior_is_the_cameras_own() -> None:
    hand = resolve(RenderRequest("grasp-approach-lamp", Path(), width=1024))
    assert with_error_set(hand, "table8").prior.sigma_t_m == (0.02, 0.02, 0.02)
    assert with_error_set(hand, "table10").told.markers.place_m.sigma == 3e-4


def test_a_scenario_names_its_set_and_reads_back_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "own.toml"
    path.write_text('name = "own"\nerrors = "realistic"\n')
    first = read_scenario(path)
    assert first.drift is not None
    assert first.calibration.sigma_focal_px > 0.0
    path.write_text(first.to_toml())
    assert read_scenario(path).fingerprint() == first.fingerprint()


def test_images_without_markers_have_no_named_errors(tmp_path: Path) -> None:
    path = tmp_path / "tumble.toml"
    path.write_text('errors = "table5"\n' + case_path("xmm-tumble").read_text())
    with pytest.raises(ScenarioError, match="only with image pairs or colour"):
        read_scenario(path)


def test_every_set_has_a_name_of_its_own() -> None:
    assert set(ALONE) < set(ERROR_SETS)
    assert len(set(map(repr, ERROR_SETS.values()))) == len(ERROR_SETS)
