"""What is on board of the light: true without errors, off by its sigmas with."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from bench.suites.uncooperative_suns.cases import MotionTask
from bench.suites.uncooperative_suns.frames import drawn as drawn_motion
from bench.suites.uncooperative_suns.frames import scenario_of
from bench.suites.uncooperative_suns.told import LEVEL_SIGMA, onboard_of
from models.dataset.onboard_files import onboard_texts
from models.errors import ScenarioError
from models.onboard import OnboardKnowledge
from models.spacecraft.catalogue import spacecraft_by_name
from models.spacecraft.wireframes import wireframe_by_name
from models.wireframe.finish import Finish
from renders.detector.expose import electron_rate, mean_electrons
from renders.scenario.scenario import Scenario, check_scenario
from renders.tracing.light_groups import SunGroup
from renders.world.build import world_of
from renders.world.told_light import FINISHES, WHITE, TrueFinish, white_dn_ms
from renders.world.world import World
from tests.support.tumble_scenario import TUMBLE, tumble_table

SIGMAS = {"sun_sigma_deg": 0.3, "finish_sigma": 0.2, "white_sigma": 0.1}
EXACT = dict.fromkeys(SIGMAS, 0.0)
RUNS = 200
PIXEL_RESPONSE = 0.03  # pixels differ by 1 %, and vignetting in the middle by nothing
SCATTER = 0.15  # of a sigma from 200 draws: three times 1 / sqrt(400)


def tumbling(onboard: dict[str, Any], **changes: Any) -> World:
    tumble = {**TUMBLE, "onboard": onboard}
    return world_of(Scenario.model_validate(tumble_table(tumble=tumble, **changes)))


def finish_of(onboard: OnboardKnowledge) -> Finish:
    assert onboard.wireframe is not None
    assert onboard.wireframe.finish is not None
    return onboard.wireframe.finish


def white_of(onboard: OnboardKnowledge) -> float:
    assert onboard.expectations is not None
    assert onboard.expectations.white_dn_ms is not None
    return onboard.expectations.white_dn_ms


def test_nothing_is_told_unless_it_is_typed() -> None:
    onboard = tumbling({}).onboard(0)
    assert onboard.wireframe is not None
    assert onboard.wireframe.finish is None
    assert onboard.expectations is not None
    assert onboard.expectations.white_dn_ms is None
    assert not onboard.expectations.earth_shines
    assert not onboard.sigmas


def test_where_the_sun_is_told_so_is_whether_the_earth_shines() -> None:
    for shines in (False, True):
        world = tumbling({"sun_sigma_deg": 0.3}, earth={"shines": shines})
        expected = world.onboard(0).expectations
        assert expected is not None
        assert expected.earth_shines is shines
        assert expected.earth_dir_in_inertial is None  # the chaser's orbit has it


def test_without_errors_every_run_has_the_true_light() -> None:
    world = tumbling(EXACT)
    one, other = world.onboard(0), world.onboard(7)
    assert finish_of(one).table.tobytes() == finish_of(other).table.tobytes()
    assert white_of(one) == white_of(other) == white_dn_ms(world.scenario)
    assert FINISHES not in one.sigmas


def test_a_run_has_the_same_light_each_time_and_another_than_the_next() -> None:
    world = tumbling(SIGMAS)
    texts = [onboard_texts(tumbling(SIGMAS).onboard(3)), onboard_texts(world.onboard(3))]
    assert texts[0] == texts[1]
    assert onboard_texts(world.onboard(4))["wireframe.json"] != texts[0]["wireframe.json"]
    assert world.onboard(3).sigmas == {FINISHES: 0.2, WHITE: 0.1}


def test_levels_scatter_by_their_sigma() -> None:
    world = tumbling({"sun_sigma_deg": 0.3, "white_sigma": 0.1})
    true = white_dn_ms(world.scenario)
    off = np.log([white_of(world.onboard(run)) / true for run in range(RUNS)])
    assert off.std() == pytest.approx(0.1, rel=SCATTER)
    assert abs(off.mean()) < 3.0 * 0.1 / np.sqrt(RUNS)


def test_a_material_is_off_alike_wherever_it_is_and_no_other_with_it() -> None:
    spacecraft, wireframe = spacecraft_by_name("xmm"), wireframe_by_name("xmm")
    finish = TrueFinish(wireframe, spacecraft)
    true, darker = (finish.told(0.2, {"solar_cell": off}).finish for off in (0.0, -1.0))
    assert true is not None
    assert darker is not None
    changed = darker.mirror != true.mirror
    assert changed.any()
    on_wings = np.abs(wireframe.triangles_in_target[..., 1]).min(axis=1) > 2.0
    assert not changed[~on_wings].any()
    assert not changed.all(axis=1).any()  # cells are on one side
    ratio = (darker.mirror / true.mirror)[changed]
    assert np.exp(-0.2) < ratio.min()  # something else is there too,
    assert ratio.max() < np.exp(-0.5 * 0.2)  # but most of it is cells


def test_sunlit_white_is_what_the_camera_sees_of_it() -> None:
    """Through the detector's own light: a white face is as bright all over as E / pi."""
    scenario = tumbling({}).scenario
    optics, detector = scenario.simulated_optics, scenario.simulated_detector
    camera = scenario.simulated_camera
    sun = SunGroup("sun_any", (0.0, 0.0, 1.0))
    even = np.full((camera.height, camera.width), sun.irradiance_w_m2 / np.pi, dtype=np.float32)
    rate = electron_rate({sun: even}, optics, detector)
    taken_ms = 2.0
    charge = mean_electrons(rate, taken_ms, camera, optics, detector)
    dark_e = detector.dark_current_e_s * 1e-3 * taken_ms
    middle = charge[camera.height // 2, camera.width // 2] - dark_e
    told = white_dn_ms(scenario) * taken_ms * detector.gain_e_dn
    assert told == pytest.approx(middle, rel=PIXEL_RESPONSE)


def test_the_suite_tells_what_a_tumble_tells() -> None:
    """One way for both: of the same camera, white is the same, but for a start's own error."""
    task = MotionTask("xmm", "", 0, 3, 256, 8)
    onboard = onboard_of(task, drawn_motion(task), 0, 0.3)
    off = np.log(white_of(onboard) / white_dn_ms(scenario_of(task)))
    assert 0.0 < abs(off) < 5.0 * LEVEL_SIGMA
    assert onboard.wireframe is not None
    told = finish_of(tumbling(SIGMAS).onboard(0))
    assert finish_of(onboard).table.shape == told.table.shape


@pytest.mark.parametrize(
    ("onboard", "said"),
    [
        ({"finish_sigma": 0.2}, "finish_sigma.*give sun_sigma_deg too"),
        ({"white_sigma": 0.1}, "white_sigma.*give sun_sigma_deg too"),
        ({"sun_sigma_deg": 0.3, "finish_sigma": 0.2, "knows_target": False}, "knows_target"),
    ],
)
def test_what_nobody_could_use_is_refused(onboard: dict[str, Any], said: str) -> None:
    scenario = Scenario.model_validate(tumble_table(tumble={**TUMBLE, "onboard": onboard}))
    with pytest.raises(ScenarioError, match=said):
        check_scenario(scenario, "typed.toml")
