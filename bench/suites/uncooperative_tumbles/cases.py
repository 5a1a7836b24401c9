"""What is drawn of the study: a target's attitude and spin, its Sun, and how often it is looked at.

Each draw is keyed by the seed, the target and the number of the tumble, and never in sequence.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

import bench
from bench.random_dataset.draws import at_angle, log_uniform
from bench.suites.uncooperative_suns.cases import (
    OFF_AXIS,
    ORBIT,
    PHASES_DEG,
    RATES_DEG_S,
    SHARES,
    STEPS_S,
    SUN_SIGMA_DEG,
    MotionTask,
    any_direction,
)
from bench.suites.uncooperative_suns.frames import F_NUMBER, FIRST_MS
from bench.suites.uncooperative_suns.told import LEVEL_SIGMA, REFLECTANCE_SIGMA, SIGMA_PX
from models.arrays import Floats
from models.camera import Camera
from models.lights.earth import EARTH_RADIUS_KM, GEO_RADIUS_KM
from models.motion.tumble import CAM_FROM_LVLH
from models.spacecraft.mass_model import mass_properties, maxar1300_lumps
from renders.scenario.own_target import wireframe_of, with_own_target_read
from renders.scenario.scenario import Scenario, check_scenario

IMAGES = 30
TUMBLE_DRAW, RENDER_DRAW = 11, 12  # purposes that key the draws
SHADOW_MARGIN_DEG = 5.0  # of the Earth's disc: in ten minutes it moves by 2.5 deg


@dataclass(frozen=True, eq=False)
class DrawnTumble:
    """A tumble as it was drawn.

    Attributes
    ----------
    lvlh_from_target : Rotation
        At time zero.
    omega_deg_s : (3,) array, deg/s
        In target axes.
    rho_m : (3,) array, m
        Chaser to target, local frame.
    step_s : float, s
        Between images.
    share : float
        Of the field's width that the target is across.
    phase_deg : float, deg
        Between Sun and camera, as the target sees them first.
    sun_in_inertial : (3,) array
    earth_shines : bool
    """

    lvlh_from_target: Rotation
    omega_deg_s: Floats
    rho_m: Floats
    step_s: float
    share: float
    phase_deg: float
    sun_in_inertial: Floats
    earth_shines: bool

    @property
    def rate_deg_s(self) -> float:
        """How fast it spins at first, deg/s."""
        return float(np.linalg.norm(self.omega_deg_s))


def draw_tumble(task: MotionTask, camera: Camera, radius_m: float) -> DrawnTumble:
    """Draw a tumble.

    Parameters
    ----------
    task : MotionTask
    camera : Camera
    radius_m : float, m
        Of the target about its origin.
    """
    rng = task.rng(TUMBLE_DRAW)
    attitude = Rotation.random(rng=rng)
    omega = log_uniform(rng, RATES_DEG_S) * any_direction(rng)
    step_s, share = log_uniform(rng, STEPS_S), log_uniform(rng, SHARES)
    range_m = 2.0 * radius_m / (share * camera.width / camera.fx)
    middle = 0.5 * np.array([camera.width - 1.0, camera.height - 1.0])
    off = 0.5 * OFF_AXIS * rng.uniform(-1.0, 1.0, 2) * np.array([camera.width, camera.height])
    place = range_m * camera.rays((middle + off)[None])[0]
    phase_deg, sun = _sun(rng, place)
    inertial_from_cam = ORBIT.inertial_from_lvlh(0.0) @ CAM_FROM_LVLH.rotation.T
    return DrawnTumble(
        lvlh_from_target=attitude,
        omega_deg_s=omega,
        rho_m=CAM_FROM_LVLH.rotation.T @ place,
        step_s=step_s,
        share=share,
        phase_deg=phase_deg,
        sun_in_inertial=inertial_from_cam @ sun,
        earth_shines=task.number % 2 == 0,
    )


def _sun(rng: np.random.Generator, place: Floats) -> tuple[float, Floats]:
    """Draw a Sun by its phase angle, camera axes, not behind the Earth, which is below."""
    down = np.array([0.0, 1.0, 0.0])
    edge = np.arcsin(EARTH_RADIUS_KM / GEO_RADIUS_KM) + np.deg2rad(SHADOW_MARGIN_DEG)
    while True:
        phase_deg = float(rng.uniform(*PHASES_DEG))
        sun = at_angle(rng, -place / np.linalg.norm(place), float(np.deg2rad(phase_deg)))
        if sun @ down < np.cos(edge):
            return phase_deg, sun


@lru_cache(maxsize=8)
def drawn_scenario(task: MotionTask) -> tuple[DrawnTumble, Scenario]:
    """Return a task's tumble, and the scenario that renders it.

    Raises
    ------
    ScenarioError
        If the target cannot be rendered, or has no wireframe.
    """
    still = _scenario(task, None)
    radius_m = wireframe_of(still).radius_m
    drawn = draw_tumble(task, still.simulated_camera, radius_m)
    return drawn, check_scenario(_scenario(task, drawn), f"the suite's target {task.target}")


def _scenario(task: MotionTask, drawn: DrawnTumble | None) -> Scenario:
    tumble: dict[str, Any] = {
        "orbit": {"a_km": GEO_RADIUS_KM},
        "rho0_m": [0.0, 1000.0, 0.0],
        "omega0_deg_s": [0.0, 0.0, 0.0],
        "onboard": {
            "sigma_px": SIGMA_PX,
            "sun_sigma_deg": SUN_SIGMA_DEG,
            "finish_sigma": REFLECTANCE_SIGMA,
            "white_sigma": LEVEL_SIGMA,
        },
        **_inertia(task.target),
    }
    motion, sun, shines = {"end_s": 0.0, "rate_hz": 1.0}, np.array([0.0, 1.0, 0.0]), False
    if drawn is not None:
        tumble |= {
            "rho0_m": drawn.rho_m.tolist(),
            "omega0_deg_s": drawn.omega_deg_s.tolist(),
            "q_lvlh_from_target_wxyz": drawn.lvlh_from_target.as_quat(scalar_first=True).tolist(),
        }
        motion = {"end_s": drawn.step_s * (task.images - 0.5), "rate_hz": 1.0 / drawn.step_s}
        sun, shines = drawn.sun_in_inertial, drawn.earth_shines
    table: dict[str, Any] = {
        "name": "uncooperative-tumbles",
        "target": task.target,
        "frame": {"kind": "single"},
        "camera": {"width": task.width},
        "optics": {"f_number": F_NUMBER},
        "render": {
            "samples": task.samples,
            "seed": int(task.rng(RENDER_DRAW).integers(2**31)),
        },
        "earth": {"shines": shines},
        "sun": {"default": ",".join(repr(float(x)) for x in sun)},
        "motion": motion,
        "exposure": {"mode": "fixed", "exposure_ms": FIRST_MS},
        "tumble": tumble,
    }
    with_own_target_read(table, Path.cwd() / "suite")
    return Scenario(**table)


def _inertia(target: str) -> dict[str, Any]:
    """Return what a tumble must be told of a target's inertia; of one's own its file tells."""
    if target == "maxar1300_unmarked":
        return {"inertia_kg_m2": mass_properties(maxar1300_lumps()).inertia.tolist()}
    path = Path(bench.__file__).parent / "reference" / "pesce2019.toml"
    printed = tomllib.loads(path.read_text())["inertia_kg_m2"]
    own = {name.lower(): value for name, value in printed.items()}
    return {"inertia_kg_m2": own[target]} if target in own else {}
