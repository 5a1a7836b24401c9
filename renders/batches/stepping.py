"""A simulation that goes on frame by frame, for who steers the camera from outside.

What a case's batch renders as a whole is here asked for one frame at a time, at times and poses
that come from anywhere: a guidance loop, say, that acts on what a pipeline made of the frame
before. Fed a batch's own times and poses, it gives the batch's frames to the bit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import ClassVar, Literal, TypeAlias

import numpy as np

from models.arrays import Floats, Image
from models.errors import ScenarioError
from models.frame import Frame, ImageReading, Reading
from models.lights.sun import unit_direction
from models.onboard import OnboardKnowledge
from models.pose import RigidTransform
from models.spacecraft.inside import is_inside
from renders.batches.studio import Studio, start_renderer
from renders.detector.compose import compose
from renders.scenario.camera_tables import LONGEST_MS, SHORTEST_MS
from renders.scenario.scenario import RenderRequest, resolve
from renders.store.kept_light import LightKeeping
from renders.store.light_keys import LightKeys
from renders.store.radiance_store import RadianceStore, default_store
from renders.variant.choice import choose_variant
from renders.world.build import world_of
from renders.world.exposure import Exposure
from renders.world.sky import Turning
from renders.world.trajectory import Trajectory
from renders.world.world import World

Pose: TypeAlias = RigidTransform | Callable[[float], RigidTransform]


@dataclass(frozen=True, eq=False)
class Steered:
    """A motion that comes from outside, asked once for each instant.

    Attributes
    ----------
    pose : RigidTransform or callable
        One that holds, or ``pose(time_s)``.
    """

    pose: Pose
    known: dict[float, RigidTransform] = field(default_factory=dict)

    def cam_from_target(self, time_s: float) -> RigidTransform:
        """Return the true pose.

        Raises
        ------
        ScenarioError
            If what was called for a pose gave something else.
        """
        if time_s not in self.known:
            pose = self.pose if isinstance(self.pose, RigidTransform) else self.pose(time_s)
            if not isinstance(pose, RigidTransform):
                raise ScenarioError(
                    f"expected a RigidTransform cam_from_target at {time_s:g} s, "
                    f"got {type(pose).__name__}"
                )
            self.known[time_s] = pose
        return self.known[time_s]


@dataclass(frozen=True, eq=False)
class WithSunAt:
    """A sky whose Sun stands where it is told to, and all else where it was.

    Attributes
    ----------
    turning : Turning
    sun_dir_in_target : tuple of 3 floats
    """

    turning: Turning
    sun_dir_in_target: tuple[float, float, float]
    suns_stand_still: ClassVar[bool] = False

    def sun_in_target(self, direction: tuple[float, float, float], time_s: float) -> list[float]:
        """Return it as told."""
        return list(self.sun_dir_in_target)

    def earth_at(self, time_s: float) -> tuple[Floats, float]:
        """Return the (3,) unit vector to the Earth's centre, target frame, and its distance, km."""
        return self.turning.earth_at(time_s)

    def target_from_icrs(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation of the target among the stars."""
        return self.turning.target_from_icrs(time_s)


class Simulation:
    """A running simulation of a case: one frame after another, as a flight computer gets them.

    Random numbers are keyed by run, frame and exposure, as in a batch. Light that is in the store
    is taken from there; none is put there. Steering moves the chaser: where Sun, Earth and stars
    stand in the target's axes stays what the scenario says.

    Parameters
    ----------
    case : str
        Name of a case, or path of a scenario file.
    run : int
        Keys detector noise, prior and calibration.
    sun : str, optional
        A name such as S1 or E-S15, or x,y,z.
    start_s, end_s : float, optional, s
        Of the scenario's own motion: the prior is that of its start.
    width : int, optional, px
    spp : int, optional
        Samples per pixel.
    variant : str
        auto, llvm, cuda or scalar.
    store : Path, optional
        Folder of the radiance store.
    threads : int, optional

    Attributes
    ----------
    world : World
    onboard : OnboardKnowledge
        What a pipeline is told before the first frame.

    Raises
    ------
    ScenarioError, VariantError
        If the case or an option cannot be used.

    Examples
    --------
    A loop that holds the camera where it is until the pipeline knows better::

        simulation = Simulation("maxar-approach", width=512)
        pipeline = PIPELINE.make(simulation.onboard, "best")
        pose = simulation.world.trajectory.cam_from_target(0.0)
        for number in range(10):
            frame = simulation.frame(0.2 * number, pose)
            pose = guidance(pipeline.process(frame))
    """

    def __init__(
        self,
        case: str,
        run: int = 0,
        *,
        sun: str | None = None,
        start_s: float | None = None,
        end_s: float | None = None,
        width: int | None = None,
        spp: int | None = None,
        variant: Literal["auto", "llvm", "cuda", "scalar"] = "auto",
        store: Path | None = None,
        threads: int | None = None,
    ) -> None:
        if isinstance(run, bool) or not isinstance(run, int) or run < 0:
            raise ScenarioError(f"expected run as a whole number of at least 0, got {run!r}")
        request = RenderRequest(
            case,
            Path(),
            sun=sun,
            start_s=start_s,
            end_s=end_s,
            width=width,
            spp=spp,
            threads=threads,
        )
        world = world_of(resolve(request))
        self.world: World = replace(world, sky=replace(world.sky, shared=()))
        self.run = run
        self.onboard: OnboardKnowledge = world.onboard(run)
        full_variant = choose_variant(variant)
        family = "scalar" if full_variant.startswith("scalar") else "jit"
        self._studio = Studio(
            self.world,
            RadianceStore(store or default_store()),
            LightKeys(self.world, family),
            world.target.markers,
            kept=LightKeeping("none"),
        )
        start_renderer(full_variant, threads)
        self._last: Frame | None = None
        self._last_s = -np.inf

    def frame(
        self,
        time_s: float,
        cam_from_target: Pose | None = None,
        *,
        sun_dir_in_target: Sequence[float] | Floats | None = None,
        exposure_ms: float | None = None,
    ) -> Frame:
        """Return the next frame.

        Parameters
        ----------
        time_s : float, s
            Of the frame, after that before; of a pair, middle of the 850 nm exposure.
        cam_from_target : RigidTransform or callable, optional
            The true pose: one that holds for all exposures of the frame, or ``pose(time_s)``, asked
            at the middle of each exposure (and, where stars shine or ``[shutter]`` is open, within
            and beside it). Unless given, that of the scenario's own motion.
        sun_dir_in_target : (3,) array, optional
            Towards the Sun, any length; unless given, as the scenario says. One that is given
            shines, wherever the Earth stands.
        exposure_ms : float, optional, ms
            Unless given, as the scenario plans, types or meters it.

        Raises
        ------
        ScenarioError
            If the time does not rise or is outside a free target's motion, the camera would be
            inside the target, or a value cannot be. The simulation goes on after it.
        """
        time_s = self._next_time(time_s)
        world = self._world(cam_from_target, sun_dir_in_target)
        number = 0 if self._last is None else self._last.index + 1
        exposures = world.sensor.exposures(number, time_s)
        for exposure in exposures:
            _check_outside(world, exposure)
        if exposure_ms is None:
            exposure_ms = self._exposure_ms(time_s)
        if not SHORTEST_MS <= exposure_ms <= LONGEST_MS:
            raise ScenarioError(
                f"expected exposure_ms from {SHORTEST_MS:g} to {LONGEST_MS:g}, got {exposure_ms!r}"
            )
        self._studio.world, self._studio.open_ms = world, exposure_ms
        readings: dict[str, Reading] = {}
        clock = self.world.clock(self.run)
        for exposure in exposures:
            stream = world.sensor.stream(exposure.band)
            image = self._image(world, exposure, exposure_ms)
            middle_s = clock.shows(time_s) + stream.offset_s
            readings[stream.name] = ImageReading(image, middle_s, exposure_ms)
        for sensor in world.tables:
            rows = sensor.along(world.trajectory).reading(number, time_s, self._last_s, self.run)
            readings[sensor.name] = clock.stamped_rows(rows)
        self._last, self._last_s = Frame(number, clock.shows(time_s), readings), time_s
        return self._last

    def _next_time(self, time_s: float) -> float:
        time_s = float(time_s)
        if not self._last_s < time_s < np.inf:
            raise ScenarioError(
                f"expected time_s after the frame before, {self._last_s:g} s, and finite, "
                f"got {time_s:g} s"
            )
        if self.world.absolute is not None:
            self.world.absolute.check_time(time_s)
        return time_s

    def _world(
        self, pose: Pose | None, sun_dir_in_target: Sequence[float] | Floats | None
    ) -> World:
        """Return the world of one frame."""
        motion: Trajectory = self.world.trajectory if pose is None else Steered(pose)
        sky = self.world.sky
        if sun_dir_in_target is not None:
            x, y, z = unit_direction(sun_dir_in_target).tolist()
            turned = WithSunAt(sky.turning, (x, y, z))
            sky = replace(sky, turning=turned, eclipses=False)
        return replace(self.world, trajectory=motion, sky=sky)

    def _exposure_ms(self, time_s: float) -> float:
        plan = self.world.plan
        if self._last is None or not plan.metered:
            return plan.before_any_image(time_s, self.onboard.prior)
        last = self._last.image(self.world.sensor.streams[-1].name)
        detector = self.world.scenario.simulated_detector
        return plan.meter.next_ms(last.exposure_ms, last.image, detector)

    def _image(self, world: World, exposure: Exposure, exposure_ms: float) -> Image:
        cam_from_target = world.trajectory.cam_from_target(exposure.time_s)
        groups = self._studio.light(exposure, cam_from_target)
        depth_m = None
        if world.scenario.needs_depth:
            depth_m = self._studio.pixel_truth(exposure, cam_from_target).depth_m
        return compose(world, groups, exposure, exposure_ms, self.run, depth_m)


def _check_outside(world: World, exposure: Exposure) -> None:
    place = world.trajectory.cam_from_target(exposure.time_s).inverse().translation
    if not np.isfinite(place).all() or is_inside(world.target, place):
        where = ", ".join(f"{x:.2f}" for x in place)
        raise ScenarioError(
            f"expected the camera outside {world.target.name}; at {exposure.time_s:g} s it is at "
            f"({where}) m in the target frame"
        )
