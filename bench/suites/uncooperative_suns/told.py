"""What is on board of one start: the light, what surfaces reflect, and the camera's level.

None of it is exact: the Sun's direction is off by the chaser's attitude, each material's
reflectance by age and by what nobody measured, the camera's level by its calibration.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from bench.suites.uncooperative_suns.cases import DrawnMotion, MotionTask, told_sun
from bench.suites.uncooperative_suns.frames import scenario_of
from models.motion.tumble import CAM_FROM_LVLH
from models.onboard import FlightExpectations, OnboardKnowledge, needed
from renders.scenario.own_target import target_of, wireframe_of
from renders.world.build import world_of
from renders.world.told_light import TrueFinish, white_dn_ms

SIGMA_PX = 0.7
REFLECTANCE_SIGMA = 0.2  # of each material's, as a share: log-normal
LEVEL_SIGMA = 0.1  # of the camera's, likewise
FINISH_DRAW, LEVEL_DRAW = 4, 5  # purposes that key the draws


@dataclass(frozen=True, eq=False)
class TrueTarget:
    """A target as it is.

    Attributes
    ----------
    onboard : OnboardKnowledge
        Camera and detector.
    finish : TrueFinish
        Of its wireframe.
    white_dn_ms : float, DN/ms
    """

    onboard: OnboardKnowledge
    finish: TrueFinish
    white_dn_ms: float


@lru_cache(maxsize=4)
def _true(target: str, shape: str, width: int, samples: int) -> TrueTarget:
    scenario = scenario_of(MotionTask(target, shape, 0, 0, width, samples))
    return TrueTarget(
        world_of(scenario).onboard(0),
        TrueFinish(wireframe_of(scenario), target_of(scenario)),
        white_dn_ms(scenario),
    )


def onboard_of(
    task: MotionTask, drawn: DrawnMotion, number: int, sun_sigma_deg: float
) -> OnboardKnowledge:
    """Return what a start has on board.

    Parameters
    ----------
    task : MotionTask
    drawn : DrawnMotion
        As the task draws it.
    number : int
        Of the Sun among those of the motion.
    sun_sigma_deg : float, deg
        Per axis.
    """
    true = _true(task.target, task.shape, task.width, task.samples)
    names = true.finish.materials
    off = task.rng(FINISH_DRAW).standard_normal(len(names)).tolist()
    level = float(np.exp(LEVEL_SIGMA * task.rng(LEVEL_DRAW).standard_normal()))
    return OnboardKnowledge(
        camera=needed(true.onboard.camera, "camera.toml", "the suite"),
        detector=needed(true.onboard.detector, "detector.toml", "the suite"),
        wireframe=true.finish.told(REFLECTANCE_SIGMA, dict(zip(names, off, strict=True))),
        expectations=FlightExpectations(
            CAM_FROM_LVLH,
            SIGMA_PX,
            sun_dir_in_inertial=told_sun(
                task, number, drawn.suns_in_inertial[number], sun_sigma_deg
            ),
            sun_sigma_deg=sun_sigma_deg,
            earth_shines=drawn.earth_shines[number],
            earth_dir_in_inertial=drawn.earth_in_inertial if drawn.earth_shines[number] else None,
            white_dn_ms=level * true.white_dn_ms,
        ),
    )
