"""What is loaded on board in a run: as calibrated, as surveyed, as drawn; each draw has its key."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from models.camera import Camera
from models.errors import ScenarioError
from models.motion.prior import draw_prior
from models.onboard import FlightExpectations, OnboardKnowledge, PosePrior
from models.sensors.camera_chip import Detector
from models.wireframe.wireframe import Wireframe
from renders.scenario.scenario import CalibrationTable, PriorTable
from renders.world.bodies import Bodies
from renders.world.trajectory import Trajectory

PRIOR_DRAW, CALIBRATION_DRAW = 101, 102  # purposes that key a run's random numbers


@dataclass(frozen=True, eq=False)
class FirstPose:
    """The pose at the first frame, wrong by its sigmas.

    Attributes
    ----------
    trajectory : Trajectory
    start_s : float, s
    table : PriorTable
    """

    trajectory: Trajectory
    start_s: float
    table: PriorTable

    def drawn(self, run: int) -> PosePrior:
        """Return it as a run has it."""
        truth = self.trajectory.cam_from_target(self.start_s)
        sigma_m = np.array(self.table.sigma_t_m)
        sigma_deg = np.array(self.table.sigma_euler_deg)
        rng = np.random.default_rng([run, PRIOR_DRAW])
        return PosePrior(draw_prior(truth, sigma_m, sigma_deg, rng), sigma_m, sigma_deg)


@dataclass(frozen=True, eq=False)
class BeforeFlight:
    """What a scenario has put on board.

    Attributes
    ----------
    camera : Camera
        As simulated.
    calibration : CalibrationTable
        How far its calibration may be off.
    detector : Detector
    marked : Bodies or None
        Of which the markers are known.
    first_pose : FirstPose or None
    wireframe : Wireframe or None
    expectations : FlightExpectations or None
    """

    camera: Camera
    calibration: CalibrationTable
    detector: Detector
    marked: Bodies | None = None
    first_pose: FirstPose | None = None
    wireframe: Wireframe | None = None
    expectations: FlightExpectations | None = None

    def in_run(self, run: int) -> OnboardKnowledge:
        """Return what a run has on board: its own prior and its own calibration.

        Raises
        ------
        ScenarioError
            If markers are to be known of a target that has none.
        """
        markers = None
        if self.marked is not None:
            markers = self.marked.target.markers
            if markers is None:
                raise ScenarioError(
                    f"expected a target with markers, {self.marked.target.name} has none; "
                    "the 800/850 nm pair shows retroreflectors only"
                )
        return OnboardKnowledge(
            camera=self.calibrated_camera(run),
            detector=self.detector,
            markers=markers,
            prior=None if self.first_pose is None else self.first_pose.drawn(run),
            wireframe=self.wireframe,
            expectations=self.expectations,
        )

    def calibrated_camera(self, run: int) -> Camera:
        """Return the camera as a run's calibration has it."""
        draw = np.random.default_rng([run, CALIBRATION_DRAW]).standard_normal(4)
        focal = self.calibration.sigma_focal_px
        centre = self.calibration.sigma_principal_point_px
        return replace(
            self.camera,
            fx=float(self.camera.fx + focal * draw[0]),
            fy=float(self.camera.fy + focal * draw[1]),
            cx=float(self.camera.cx + centre * draw[2]),
            cy=float(self.camera.cy + centre * draw[3]),
        )
