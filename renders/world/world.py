"""From a scenario to the things it names: camera, lamps, Suns, motion, and what flies on board.

Nothing here renders, and each random draw is keyed by its run and purpose.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from models.arrays import Floats, Mask
from models.camera import Camera
from models.dataset.dataset import FrameEntry
from models.errors import ScenarioError
from models.frame import FlightKnowledge
from models.lights.earth import Earth
from models.lights.led_beam import LedRing
from models.lights.sun import SUN_CASES_DEG, sun_direction, unit_direction
from models.materials import BandReflectance
from models.motion.approach import Approach
from models.motion.prior import draw_prior
from models.pose import RigidTransform
from models.spacecraft.catalogue import spacecraft_by_name
from models.spacecraft.inside import is_inside
from models.spacecraft.part import Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.detector.expose import SUNLIGHT_NM, electrons_per_radiance
from renders.scenario.scenario import Scenario
from renders.tracing.light_groups import (
    NIR800,
    NIR850,
    SUNLIGHT,
    EarthGroup,
    LampGroup,
    LightGroup,
    SunGroup,
)
from renders.tracing.silhouette import in_sight, pieces_of, pixels_in_view, sees

PRIOR_DRAW, CALIBRATION_DRAW = 101, 102  # purposes that key a run's random numbers
BANDS = (800, 850)


@dataclass(frozen=True)
class Exposure:
    """One image to be taken: frame number, band and middle of the exposure, s.

    The band is 800 or 850, or ``models.dataset.dataset.FILTERED`` for a single image.
    """

    frame: int
    band: int
    time_s: float


class Trajectory(Protocol):
    """A true motion: the pose at any instant."""

    def cam_from_target(self, time_s: float, /) -> RigidTransform:
        """Return the true pose."""
        ...


@dataclass(frozen=True)
class World:
    """A scenario's things: image pairs of a target with markers; see ``renders.scenario.scenario``.

    What depends on time is asked for an exposure: see ``renders.world.tumble_world`` for a world in
    which Sun and Earth move through the target's sky.
    """

    scenario: Scenario

    @property
    def bands(self) -> tuple[int, ...]:
        """The exposures of one frame, in order of time; the last meters the next frame."""
        return BANDS

    @cached_property
    def camera(self) -> Camera:
        """The camera that renders."""
        return self.scenario.simulated_camera

    @cached_property
    def target(self) -> Spacecraft:
        """The target, in the target frame."""
        return spacecraft_by_name(self.scenario.target)

    @cached_property
    def chaser(self) -> Spacecraft | None:
        """The chaser, in the camera's frame; None where it is too far off to matter."""
        return spacecraft_by_name("chaser")

    @cached_property
    def approach(self) -> Approach:
        """The true motion."""
        if self.scenario.motion.target_wobble:
            return Approach()
        return Approach(pointing_accuracy_deg=0.0)

    @property
    def trajectory(self) -> Trajectory:
        """The true motion, whatever moves."""
        return self.approach

    @cached_property
    def flight_plan(self) -> Approach:
        """The motion that the chaser reckons with: the target does not sway."""
        return replace(self.approach, pointing_accuracy_deg=0.0)

    @cached_property
    def optics(self) -> RetroreflectorOptics:
        """What the markers return."""
        table = self.scenario.retroreflector
        return RetroreflectorOptics(
            half_angle_deg=table.half_angle_deg,
            returned=BandReflectance(0.0, table.returned_800, table.returned_850),
        )

    @cached_property
    def exposures(self) -> list[Exposure]:
        """All exposures in order of time, 800 nm before 850 nm."""
        gap_s = self.scenario.motion.pair_gap_ms * 1e-3
        return [
            Exposure(frame, band, time_s - (gap_s if band == 800 else 0.0))
            for frame, time_s in enumerate(self.scenario.times_s)
            for band in BANDS
        ]

    def lamps(self, band: int) -> LampGroup:
        """Return the lamps of 800 or 850 nm; the two rings interleave."""
        table = self.scenario.lamps
        half_step_deg = 180.0 / table.count
        ring = LedRing(
            wavelength_nm=float(band),
            intensity_w_sr=table.intensity_w_sr,
            count=table.count,
            radius_m=table.radius_m,
            phase_deg=half_step_deg if band == 850 else 0.0,
            half_intensity_deg=table.half_intensity_deg,
        )
        return LampGroup(f"lamps_{band}", ring, NIR850 if band == 850 else NIR800)

    @cached_property
    def sun(self) -> SunGroup:
        """The Sun that shines on the frames."""
        return sun_group(self.scenario.sun.default)

    @cached_property
    def suns(self) -> list[SunGroup]:
        """Every Sun that is rendered: the shared ones, and the one asked for if not among them."""
        shared = [sun_group(name) for name in self.scenario.sun.shared]
        if self.sun.name in {sun.name for sun in shared}:
            return shared
        return [*shared, self.sun]

    def sun_at(self, sun: SunGroup, time_s: float) -> SunGroup:
        """Return a Sun as it stands at an instant: here the target hardly turns."""
        return sun

    def earth_at(self, time_s: float) -> tuple[Floats, float]:
        """Return the unit vector towards the Earth's centre, target frame, and its distance, km."""
        table = self.scenario.earth
        return unit_direction(table.direction), table.orbit_radius_km

    def earth_under(self, sun: SunGroup, time_s: float) -> list[EarthGroup]:
        """Return the Earth as a Sun lights it, if the scenario has one."""
        table = self.scenario.earth
        if not table.shines:
            return []
        direction, radius_km = self.earth_at(time_s)
        x, y, z = direction.tolist()
        earth = Earth(
            (x, y, z), sun.direction_in_target, radius_km, table.albedo, sun.irradiance_w_m2
        )
        return [EarthGroup(sun.name.replace("sun", "earth", 1), earth)]

    @cached_property
    def floodlights(self) -> list[LampGroup]:
        """The floodlight, if the scenario has one."""
        table = self.scenario.floodlight
        if table.intensity_w_sr <= 0.0:
            return []
        ring = LedRing(
            wavelength_nm=SUNLIGHT_NM,
            intensity_w_sr=table.intensity_w_sr,
            count=table.count,
            radius_m=table.radius_m,
            half_intensity_deg=table.half_intensity_deg,
            centre_in_cam=table.centre_in_cam,
        )
        return [LampGroup("floodlight", ring, SUNLIGHT)]

    def lamps_of(self, band: int) -> list[LampGroup]:
        """Return every lamp that shines on an exposure of ``band``."""
        return [*self.floodlights, self.lamps(band)]

    def lit_by(self, exposure: Exposure) -> list[LightGroup]:
        """Return the groups that light one exposure under the scenario's Sun."""
        sun = self.sun_at(self.sun, exposure.time_s)
        return [sun, *self.earth_under(sun, exposure.time_s), *self.lamps_of(exposure.band)]

    def groups(self, exposure: Exposure) -> list[LightGroup]:
        """Return every group that is rendered for an exposure; the names are those of all."""
        suns = [self.sun_at(sun, exposure.time_s) for sun in self.suns]
        earths = [earth for sun in suns for earth in self.earth_under(sun, exposure.time_s)]
        return [*suns, *earths, *self.lamps_of(exposure.band)]

    def silhouette(self, cam_from_target: RigidTransform) -> Mask | None:
        """Return the pixels that spacecraft can fill, (height, width); None: any."""
        pieces = pieces_of(self.target, self.chaser, cam_from_target)
        return pixels_in_view(pieces, self.camera, cam_from_target)

    def in_view(self, exposure: Exposure) -> Mask | None:
        """Return the pixels that can show any light, (height, width); None: any."""
        cam_from_target = self.trajectory.cam_from_target(exposure.time_s)
        for group in self.groups(exposure):
            if isinstance(group, EarthGroup) and sees(self.camera, cam_from_target, group.earth):
                return None
        return self.silhouette(cam_from_target)

    def render_seed(self, frame: int) -> int:
        """Return the seed of both exposures of a frame: their noise cancels in the difference."""
        sequence = np.random.SeedSequence([self.scenario.render.seed, frame])
        return int(sequence.generate_state(1)[0])

    def check_poses(self) -> None:
        """Refuse a motion that takes the camera inside the target, or never shows it.

        A frame without the target is one of black sky and noise, as a camera would take it.

        Raises
        ------
        ScenarioError
            The message names the time.
        """
        for exposure in self.exposures:
            cam_from_target = self.trajectory.cam_from_target(exposure.time_s)
            place = cam_from_target.inverse().translation
            if is_inside(self.target, place):
                where = ", ".join(f"{x:.2f}" for x in place)
                raise ScenarioError(
                    f"expected the camera outside the target; at {exposure.time_s:.1f} s it is at "
                    f"({where}) m in the target frame, inside {self.target.name}; "
                    "end the motion earlier (motion.end_s, or --span-s)"
                )
        self.check_view()

    def check_view(self) -> None:
        """Refuse a motion that shows the target in no image.

        Raises
        ------
        ScenarioError
        """
        if not any(self.shows_target(exposure) for exposure in self.exposures):
            motion = self.scenario.motion
            raise ScenarioError(
                f"expected a motion that shows {self.target.name} in some image, got one that "
                f"has it out of view in all {len(self.exposures)}, from {motion.start_s:g} to "
                f"{motion.end_s:g} s; choose other times (motion.start_s and end_s, or --span-s)"
            )

    def shows_target(self, exposure: Exposure) -> bool:
        """Tell whether some of the target can be within an image."""
        cam_from_target = self.trajectory.cam_from_target(exposure.time_s)
        pieces = pieces_of(self.target, None, cam_from_target)
        return in_sight(pieces, self.camera, cam_from_target)

    def knowledge(self, run: int) -> FlightKnowledge:
        """Return what is loaded on board in a run: its own prior and its own calibration."""
        if self.target.markers is None:
            raise ScenarioError(
                f"expected a target with markers, {self.target.name} has none; "
                "the 800/850 nm pair shows retroreflectors only"
            )
        first = self.approach.cam_from_target(self.scenario.times_s[0])
        sigma_m = np.array(self.scenario.prior.sigma_t_m)
        sigma_deg = np.array(self.scenario.prior.sigma_euler_deg)
        return FlightKnowledge(
            camera=self.calibrated_camera(run),
            detector=self.scenario.simulated_detector,
            markers=self.target.markers,
            prior=draw_prior(first, sigma_m, sigma_deg, np.random.default_rng([run, PRIOR_DRAW])),
            prior_sigma_m=sigma_m,
            prior_sigma_deg=sigma_deg,
        )

    def calibrated_camera(self, run: int) -> Camera:
        """Return the camera as a run's calibration has it."""
        table = self.scenario.calibration
        draw = np.random.default_rng([run, CALIBRATION_DRAW]).standard_normal(4)
        focal, centre = table.sigma_focal_px, table.sigma_principal_point_px
        return replace(
            self.camera,
            fx=float(self.camera.fx + focal * draw[0]),
            fy=float(self.camera.fy + focal * draw[1]),
            cx=float(self.camera.cx + centre * draw[2]),
            cy=float(self.camera.cy + centre * draw[3]),
        )

    def exposure_ms(self, time_s: float, prior: RigidTransform) -> float:
        """Return the planned exposure time at ``time_s``: as the square of the range by the prior.

        The flight plan's range, shifted by how far off the first prior had it, fills a marker on
        the boresight to ``exposure.marker_fill`` of the full well.
        """
        start_s = self.scenario.times_s[0]
        planned = self.flight_plan.cam_from_target(time_s).translation[2]
        offset = prior.translation[2] - self.flight_plan.cam_from_target(start_s).translation[2]
        range_m = max(planned + offset, 0.1)
        lobe = np.pi * np.sin(np.deg2rad(self.optics.half_angle_deg)) ** 2
        radiance = self.optics.returned.nir850 / lobe
        radiance *= self.scenario.lamps.intensity_w_sr / range_m**2
        detector = self.scenario.simulated_detector
        rate = radiance * electrons_per_radiance(self.scenario.simulated_optics, detector, 850.0)
        return float(1e3 * self.scenario.exposure.marker_fill * detector.full_well_e / rate)

    @property
    def exposure_share(self) -> float:
        """How much of a typed exposure time, or of a bound on it, is meant; here all of it."""
        return 1.0

    def prior(self, run: int) -> RigidTransform | None:
        """Return the first pose as drawn in a run; None where none is known on board."""
        return self.knowledge(run).prior

    def frame_entries(self, prior: RigidTransform | None) -> list[FrameEntry]:
        """Return the rows of ``frames.csv`` for a run's prior that are known before any image.

        All of them, unless each exposure is metered from the image before: then the first alone
        (see ``renders.detector.exposure_control``).
        """
        table, times_s = self.scenario.exposure, self.scenario.times_s
        if table.mode == "schedule":
            if prior is None:
                raise ScenarioError(
                    f"{self.scenario.name}: expected exposure.mode as auto or fixed where no prior "
                    "is known on board, got 'schedule'"
                )
            entries = [
                FrameEntry(frame, time_s, self.exposure_ms(time_s, prior))
                for frame, time_s in enumerate(times_s)
            ]
            self._check_schedule(entries)
            return entries
        known = times_s if table.mode == "fixed" else times_s[:1]
        return [FrameEntry(frame, time_s, table.exposure_ms) for frame, time_s in enumerate(known)]

    def _check_schedule(self, entries: list[FrameEntry]) -> None:
        """Refuse lamps so faint, or so far off, that exposures would last into the next."""
        longest = max(entries, key=lambda entry: entry.exposure_ms)
        gap_ms = self.scenario.motion.pair_gap_ms
        if longest.exposure_ms >= gap_ms:
            raise ScenarioError(
                f"expected exposures below motion.pair_gap_ms, {gap_ms:g} ms, got one of "
                f"{longest.exposure_ms:.3g} ms at {longest.time_s:g} s, in which the lamps fill a "
                "marker to exposure.marker_fill; give more lamps.intensity_w_sr, or "
                'exposure.mode = "fixed"'
            )


def sun_group(text: str) -> SunGroup:
    """Return the light group of a Sun named S1 to S7 or typed as x,y,z."""
    direction = sun_direction(text)
    name = text.strip().upper()
    if name not in SUN_CASES_DEG:
        name = "_".join(f"{x:+.6f}" for x in direction)
    return SunGroup(f"sun_{name}", (float(direction[0]), float(direction[1]), float(direction[2])))
