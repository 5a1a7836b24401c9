"""A scenario's things, composed: bodies, motion, sky, sensors, and what flies on board.

Each part may be exchanged alone, with ``dataclasses.replace``; which parts a scenario has is said
in ``renders.world.build``. Nothing here renders, and each random draw is keyed by its run and
purpose.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.arrays import Floats, Mask
from models.camera import Camera
from models.dataset.frame_table import FrameEntry
from models.motion.table_motion import Stills
from models.onboard import OnboardKnowledge, PosePrior
from models.pose import RigidTransform
from models.spacecraft.part import Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from models.spacecraft.stance import BODY_ALONE, Stance
from renders.scenario.scenario import Scenario
from renders.tracing.light_groups import EarthGroup, LampGroup, LightGroup, SunGroup
from renders.tracing.silhouette import pieces_of, pixels_in_view, sees
from renders.truth.makers import TruthMaker
from renders.world.arm_aboard import ArmAboard
from renders.world.bodies import Bodies
from renders.world.cameras import ImagingSensor
from renders.world.checks import Check
from renders.world.exposure import Exposure
from renders.world.exposure_plan import ExposurePlan
from renders.world.onboard import BeforeFlight
from renders.world.sky import Sky
from renders.world.table_sensors import TableSensor
from renders.world.told import ToldClock
from renders.world.trajectory import FreeMotion, Trajectory


@dataclass(frozen=True, eq=False)
class World:
    """What a dataset is of.

    Attributes
    ----------
    scenario : Scenario
        From which it was composed.
    chain : str
        Name of the chain that judges its datasets.
    bodies : Bodies
    trajectory : Trajectory
        The true motion, whatever moves.
    sky : Sky
    sensor : ImagingSensor
        The camera and its streams.
    plan : ExposurePlan
    before_flight : BeforeFlight
    truth : TruthMaker
        What is sealed of an exposure.
    checks : tuple of callables
        Each refuses a motion.
    tables : tuple of TableSensor
        The streams without images.
    absolute : FreeMotion or None
        States in an inertial frame, where there is an orbit.
    arm : ArmAboard or None
        The chaser's arm.
    """

    scenario: Scenario
    chain: str
    bodies: Bodies
    trajectory: Trajectory
    sky: Sky
    sensor: ImagingSensor
    plan: ExposurePlan
    before_flight: BeforeFlight
    truth: TruthMaker
    checks: tuple[Check, ...]
    tables: tuple[TableSensor, ...] = ()
    absolute: FreeMotion | None = None
    arm: ArmAboard | None = None

    @property
    def bands(self) -> tuple[int, ...]:
        """The exposures of one frame, in order of time; the last meters the next frame."""
        return self.sensor.bands

    @property
    def camera(self) -> Camera:
        """The camera that renders."""
        return self.sensor.camera

    @property
    def target(self) -> Spacecraft:
        """The target, in the target frame."""
        return self.bodies.target

    @property
    def chaser(self) -> Spacecraft | None:
        """The chaser, in the camera's frame; None where it is too far off to matter."""
        return self.bodies.chaser

    @property
    def optics(self) -> RetroreflectorOptics:
        """What the markers return."""
        return self.bodies.optics

    @cached_property
    def exposures(self) -> list[Exposure]:
        """All exposures in order of time."""
        return [
            exposure
            for frame, time_s in enumerate(self.scenario.times_s)
            for exposure in self.sensor.exposures(frame, time_s)
        ]

    def lamps(self, band: int) -> LampGroup:
        """Return the lamps that shine on the exposures of one band alone."""
        return self.sensor.lamps(band)

    @property
    def sun(self) -> SunGroup:
        """The Sun that shines on the frames, as typed."""
        return self.sky.sun

    @property
    def suns(self) -> list[SunGroup]:
        """Every Sun that is rendered, as typed."""
        return self.sky.suns

    def sun_at(self, sun: SunGroup, time_s: float) -> SunGroup:
        """Return a Sun as it stands at an instant, in target axes."""
        return self.sky.sun_at(sun, time_s)

    def earth_at(self, time_s: float) -> tuple[Floats, float]:
        """Return the (3,) unit vector to the Earth's centre, target frame, and its distance, km."""
        return self.sky.earth_at(time_s)

    def lit_by(self, exposure: Exposure) -> list[LightGroup]:
        """Return the groups that light one exposure under the scenario's Sun."""
        sun = self.sun_at(self.sun, exposure.time_s)
        lamps = self.sensor.stream(exposure.band).lamps
        return self.sensor.seen([*self.sky.lit_under(sun, exposure.time_s), *lamps])

    def groups(self, exposure: Exposure) -> list[LightGroup]:
        """Return every group that is rendered for an exposure; none of a Sun that is hidden."""
        suns = [self.sun_at(sun, exposure.time_s) for sun in self.suns]
        lit = [group for sun in suns for group in self.sky.lit_under(sun, exposure.time_s)]
        lit.sort(key=lambda group: isinstance(group, EarthGroup))
        return self.sensor.seen([*lit, *self.sensor.stream(exposure.band).lamps])

    def sunlit_share(self, time_s: float) -> float:
        """Return how much of the scenario's Sun the Earth leaves free at an instant, 0 to 1."""
        return self.sky.sunlit_share(self.sun_at(self.sun, time_s), time_s)

    def stance(self, time_s: float) -> Stance:
        """Return how the chaser stands at an instant; always the same if nothing moves."""
        return BODY_ALONE if self.arm is None else self.arm.stance(time_s)

    def silhouette(
        self, cam_from_target: RigidTransform, stance: Stance = BODY_ALONE
    ) -> Mask | None:
        """Return the pixels that spacecraft can fill, (height, width); None: any."""
        pieces = pieces_of(self.target, self.chaser, cam_from_target, stance)
        return pixels_in_view(pieces, self.camera, cam_from_target)

    def shows_earth(self, exposure: Exposure, cam_from_target: RigidTransform) -> bool:
        """Tell whether the Earth is in the image: then any pixel can show light."""
        return any(
            sees(self.camera, cam_from_target, group.earth)
            for group in self.groups(exposure)
            if isinstance(group, EarthGroup)
        )

    def place(self, frame: int) -> int:
        """Return the first of the frames that stand, one after the other, at a frame's pose."""
        return self._places[frame] if frame < len(self._places) else frame

    def company(self, exposure: Exposure) -> list[Exposure]:
        """Return the exposures of an exposure's band that are at its place, itself among them."""
        if not self._places:
            return [exposure]
        return self._companies[self.place(exposure.frame), exposure.band]

    @cached_property
    def _companies(self) -> dict[tuple[int, int], list[Exposure]]:
        found: dict[tuple[int, int], list[Exposure]] = {}
        for exposure in self.exposures:
            found.setdefault((self.place(exposure.frame), exposure.band), []).append(exposure)
        return found

    @cached_property
    def _places(self) -> list[int]:
        motion = self.trajectory
        if not isinstance(motion, Stills):
            return []
        first: dict[int, int] = {}
        rows = [motion.first_row(time_s) for time_s in self.scenario.times_s]
        return [first.setdefault(row, frame) for frame, row in enumerate(rows)]

    def render_seed(self, frame: int) -> int:
        """Return the seed of all exposures of a frame: their noise cancels in the difference.

        Frames that follow each other at one pose share it, and so the light that they share.
        """
        sequence = np.random.SeedSequence([self.scenario.render.seed, self.place(frame)])
        return int(sequence.generate_state(1)[0])

    def check_poses(self) -> None:
        """Refuse a motion that nobody would see, or that cannot be.

        Raises
        ------
        ScenarioError
            The message names the time.
        """
        for check in self.checks:
            check(self)

    def onboard(self, run: int) -> OnboardKnowledge:
        """Return what is loaded on board in a run.

        Raises
        ------
        ScenarioError
            If the target lacks what is to be known of it.
        """
        return self.before_flight.in_run(run)

    def clock(self, run: int) -> ToldClock:
        """Return the clock on board in a run: all that is told of times goes by it."""
        return self.before_flight.clock(run)

    def frame_entries(self, prior: PosePrior | None) -> list[FrameEntry]:
        """Return the frames for a run's prior that are known before any image, in true time."""
        return self.plan.entries(self.scenario.times_s, prior)
