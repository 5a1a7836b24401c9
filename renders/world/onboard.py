"""What is loaded on board in a run: as calibrated, as surveyed, as drawn; each draw has its key."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from models.camera import Camera
from models.errors import ScenarioError
from models.motion.prior import draw_prior
from models.onboard import FlightExpectations, OnboardKnowledge, PosePrior
from models.sensors.camera_chip import Detector
from models.spacecraft.retroreflector_optics import cubes_behind
from models.wireframe.wireframe import Wireframe
from renders.detector.drift import drift_sigmas
from renders.scenario.drift_table import DriftTable
from renders.scenario.told_tables import CalibrationTable, PriorTable, ToldTable
from renders.world.arm_told import FirstPoseByArm, ToldArm
from renders.world.bodies import Bodies
from renders.world.own_navigation import SensorsAboard
from renders.world.told import ToldClock, told
from renders.world.told_light import ToldLight
from renders.world.trajectory import Trajectory

PRIOR_DRAW = 101  # purpose that keys a run's random numbers


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

    def drawn(self, run: int, draw: int) -> PosePrior:
        """Return it as a run has it.

        Parameters
        ----------
        run : int
        draw : int
            Purpose that keys the run's random numbers.
        """
        truth = self.trajectory.cam_from_target(self.start_s)
        sigma_m = np.array(self.table.sigma_t_m)
        sigma_deg = np.array(self.table.sigma_euler_deg)
        rng = np.random.default_rng([run, draw])
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
    first_pose : FirstPose, FirstPoseByArm or None
    wireframe : Wireframe or None
    expectations : FlightExpectations or None
    psf_sigma_px : float, px
        Blur of the lens; told where ``told`` says so.
    told : ToldTable or None
        How what is told differs from all this.
    arm : ToldArm or None
        The chaser's arm, where it moves.
    drift : DriftTable or None
        What lamps and lens have become; its sigmas are told.
    navigation : SensorsAboard or None
        The chaser's own sensors, and where their filter starts.
    light : ToldLight or None
        What is told of the light and of what the target returns of it.
    """

    camera: Camera
    calibration: CalibrationTable
    detector: Detector
    marked: Bodies | None = None
    first_pose: FirstPose | FirstPoseByArm | None = None
    wireframe: Wireframe | None = None
    expectations: FlightExpectations | None = None
    psf_sigma_px: float = 0.0
    told: ToldTable | None = None
    arm: ToldArm | None = None
    drift: DriftTable | None = None
    navigation: SensorsAboard | None = None
    light: ToldLight | None = None

    def in_run(self, run: int) -> OnboardKnowledge:
        """Return what a run has on board: its own prior, and its own errors of all that is told.

        Raises
        ------
        ScenarioError
            If markers are to be known of a target that has none, or an error is too large.
        """
        markers = None
        if self.marked is not None:
            markers = self.marked.target.markers
            if markers is None:
                raise ScenarioError(
                    f"expected a target with markers, {self.marked.target.name} has none; the "
                    "800/850 nm pair shows retroreflectors only; give [markers], or take single "
                    "images, [frame] kind = 'single'"
                )
            if not markers.paint:  # told as drawn
                index = self.marked.optics.refractive_index
                cubes = cubes_behind(markers.normals_in_target, index)
                markers = replace(markers, cubes=cubes)
        true = OnboardKnowledge(
            camera=self.camera,
            detector=self.detector,
            markers=markers,
            prior=None if self.first_pose is None else self.first_pose.drawn(run, PRIOR_DRAW),
            wireframe=self.wireframe,
            expectations=self.expectations,
            psf_sigma_px=self.psf_sigma_px,
            sigmas=drift_sigmas(self.drift, self.psf_sigma_px),
            tables={
                **({} if self.arm is None else self.arm.tables(run)),
                **({} if self.navigation is None else self.navigation.tables(run)),
            },
        )
        known = true if self.light is None else self.light.on_board(true, run)
        return told(known, self.told, self.calibration, run)

    def clock(self, run: int) -> ToldClock:
        """Return the clock on board in a run."""
        return ToldClock.of(self.told, run)
