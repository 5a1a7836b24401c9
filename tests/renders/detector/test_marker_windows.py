"""Windows exposed again: the same light as in the whole image, noise of their own, nothing else."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.errors import ScenarioError
from renders.detector.compose import compose
from renders.detector.marker_windows import check_windows, cut_windows, expose_windows
from renders.scenario.scenario import RenderRequest, Scenario, resolve
from renders.world.build import world_of
from renders.world.exposure import Exposure
from renders.world.world import World

RUNS = 120
EXPOSURE_MS = 20.0
CENTRES = np.array([[40.0, 52.0], [2.0, 126.0], [90.0, 30.0], [np.nan, np.nan]])
REACH = np.array([6.0, 5.0, 7.0, 5.0])


def small(case: str, **drift: float) -> World:
    scenario = resolve(RenderRequest(case, Path(), width=128))
    if drift:
        scenario = scenario.model_copy(update={"drift": drift_table(**drift)})
    return world_of(scenario)


def drift_table(**shares: float):
    from renders.scenario.drift_table import DriftTable

    return DriftTable(**shares)


def light(world: World, exposure: Exposure):
    """Return light groups that are anything but even, and saturate nothing."""
    rng = np.random.default_rng(4)
    return {
        group: rng.uniform(0.003, 0.012, (128, 128)).astype(np.float32)
        for group in world.lit_by(exposure)
    }


@pytest.mark.parametrize("case", ["maxar-approach", "grasp-approach-lamp"])
@pytest.mark.parametrize("drift", [{}, {"lamp_power": 0.1, "lamp_tilt": 0.1, "blur": 0.2}])
def test_a_window_has_the_light_of_the_whole_image(case: str, drift: dict[str, float]) -> None:
    world = small(case, **drift)
    band = world.bands[-1]
    exposure = Exposure(0, band, 300.0)
    groups = light(world, exposure)
    windows = cut_windows(world, groups, exposure, CENTRES, REACH)
    assert windows[3] is None
    scenario = world.scenario
    # One drift for both ways, and their own noise: the mean over many is that of the light.
    noisy = np.mean(
        [
            expose_windows(
                compose(world, groups, exposure, EXPOSURE_MS, 7), windows, scenario, world.camera,
                Exposure(frame, band, 300.0), EXPOSURE_MS, 7,
            ).astype(float)
            for frame in range(RUNS)
        ],
        axis=0,
    )  # fmt: skip
    whole = np.mean(
        [
            compose(world, groups, replace(exposure, frame=frame), EXPOSURE_MS, 7).astype(float)
            for frame in range(RUNS)
        ],
        axis=0,
    )
    noise = scenario.simulated_detector.noise_dn(whole)
    for centre, reach in zip(CENTRES[:3], REACH[:3], strict=True):
        low = np.maximum(np.floor(centre - reach).astype(int), 0)
        high = np.minimum(np.ceil(centre + reach).astype(int) + 1, 128)
        place = (slice(low[1], high[1]), slice(low[0], high[0]))
        away = (noisy - whole)[place] / (noise[place] * np.sqrt(2.0 / RUNS))
        assert np.abs(away).max() < 6.0  # some hundred pixels of a normal distribution
        assert away.std() == pytest.approx(1.0, abs=0.25)


def test_nothing_but_windows_is_drawn_again_and_runs_draw_their_own() -> None:
    world = small("maxar-approach")
    exposure = Exposure(3, 850, 300.0)
    groups = light(world, exposure)
    windows = cut_windows(world, groups, exposure, CENTRES, REACH)
    image = compose(world, groups, exposure, EXPOSURE_MS, 0)
    before = image.copy()
    first, again, other = (
        expose_windows(image, windows, world.scenario, world.camera, exposure, EXPOSURE_MS, run)
        for run in (1, 1, 2)
    )
    np.testing.assert_array_equal(image, before)
    np.testing.assert_array_equal(first, again)
    changed = first != image
    assert changed[50:55, 38:43].mean() > 0.9
    touched = np.zeros_like(changed)
    for window in windows:
        if window is not None:
            touched[window.part] = True
    assert not changed[~touched].any()
    assert (first != other).any()


def with_focus(scenario: Scenario) -> Scenario:
    return scenario.model_copy(
        update={"optics": scenario.optics.model_copy(update={"focus_m": 1.0})}
    )


def test_a_lens_that_needs_the_whole_image_is_refused() -> None:
    scenario = resolve(RenderRequest("maxar-approach", Path(), width=128))
    check_windows(scenario)
    with pytest.raises(ScenarioError, match=r"optics\.focus_m to be 0"):
        check_windows(with_focus(scenario))
