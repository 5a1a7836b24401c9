"""A scenario of a free target: single images, and a sky that turns over it.

The Sun stands still in the inertial frame in which the orbit is given, the Earth lies below the
chaser; the target turns, so both move in its axes and every exposure has lights of its own. The
chaser, tens of metres off, throws no shadow that reaches it and is left out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.dataset.dataset import FILTERED, FrameEntry
from models.errors import ScenarioError
from models.frame import FlightKnowledge
from models.lights.earth import EARTH_RADIUS_KM
from models.lights.sun import sun_direction
from models.motion.chaser_navigation import corrupted
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.relative_state import ChaserState
from models.motion.tumble import CAM_FROM_LVLH, Tumble
from models.pose import RigidTransform
from models.spacecraft.wireframes import wireframe_by_name
from models.uncooperative import UncooperativeKnowledge
from models.wireframe.wireframe import Wireframe
from renders.scenario.scenario import Scenario
from renders.scenario.tumble_tables import TumbleTable
from renders.tracing.light_groups import LampGroup, SunGroup
from renders.world.world import Exposure, Trajectory, World

SHORTEST_S = 1.0  # a motion of one frame lasts, too
ON_CENTRE_M = 1e-6  # the target frame's origin is its centre of mass


@dataclass(frozen=True)
class TumbleWorld(World):
    """The things of a scenario with ``[tumble]``."""

    @property
    def table(self) -> TumbleTable:
        """What the scenario says of the motion."""
        assert self.scenario.tumble is not None
        return self.scenario.tumble

    @property
    def bands(self) -> tuple[int, ...]:
        """One exposure a frame."""
        return (FILTERED,)

    @cached_property
    def chaser(self) -> None:
        """Too far off to matter."""
        return

    @cached_property
    def orbit(self) -> KeplerOrbit:
        """The chaser's."""
        return KeplerOrbit.from_elements_deg(**self.table.orbit.model_dump())

    @cached_property
    def tumble(self) -> Tumble:
        """The true motion."""
        table = self.table
        w, x, y, z = table.q_lvlh_from_target_wxyz
        return Tumble(
            self.orbit,
            np.array(table.rho0_m),
            np.array(table.rho_dot0_m_s),
            np.deg2rad(table.omega0_deg_s),
            np.array(table.inertia_kg_m2),
            max(self.scenario.motion.end_s, SHORTEST_S),
            Rotation.from_quat([x, y, z, w]).as_matrix(),
        )

    @property
    def trajectory(self) -> Trajectory:
        """The true motion, whatever moves."""
        return self.tumble

    @cached_property
    def wireframe(self) -> Wireframe:
        """The target as drawn."""
        return wireframe_by_name(self.scenario.target)

    @cached_property
    def exposures(self) -> list[Exposure]:
        """All exposures in order of time."""
        return [
            Exposure(frame, FILTERED, time_s) for frame, time_s in enumerate(self.scenario.times_s)
        ]

    def target_from_inertial(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation from the orbit's inertial frame into target axes."""
        inertial_from_lvlh = self.orbit.inertial_from_lvlh(time_s)
        return (inertial_from_lvlh @ self.tumble.state(time_s).R_lvlh_from_target).T

    def sun_at(self, sun: SunGroup, time_s: float) -> SunGroup:
        """Return a Sun as it stands at an instant: typed in inertial axes, here in the target's."""
        x, y, z = (self.target_from_inertial(time_s) @ np.array(sun.direction_in_target)).tolist()
        return replace(sun, direction_in_target=(x, y, z))

    def earth_at(self, time_s: float) -> tuple[Floats, float]:
        """Return the unit vector towards the Earth's centre, target frame, and its distance, km."""
        position = self.tumble.chaser_state(time_s).position_in_inertial
        distance = float(np.linalg.norm(position))
        return self.target_from_inertial(time_s) @ (-position / distance), 1e-3 * distance

    def lamps_of(self, band: int) -> list[LampGroup]:
        """Return every lamp that shines: a floodlight or none."""
        return self.floodlights

    def prior(self, run: int) -> None:
        """Return no pose: none is known on board."""
        return

    def knowledge(self, run: int) -> FlightKnowledge:
        """Refuse: what is on board of a pair's chaser is not on this one's; see ``onboard``."""
        raise ScenarioError(
            f"{self.scenario.name}: expected a case of image pairs, with markers; this one gives "
            "single images of a free target"
        )

    def onboard(self, run: int) -> UncooperativeKnowledge:
        """Return what is loaded on board in a run: its own calibration, and the target as drawn."""
        table = self.table.onboard
        return UncooperativeKnowledge(
            camera=self.calibrated_camera(run),
            target=self.wireframe,
            cam_from_lvlh=CAM_FROM_LVLH,
            sigma_px=table.sigma_px,
            chaser_sigma_m=table.chaser_sigma_m,
            chaser_sigma_m_s=table.chaser_sigma_m_s,
            range_m=(table.range_m[0], table.range_m[1]) if table.range_m else None,
            detector=self.scenario.simulated_detector,
            inertia_kg_m2=np.array(self.table.inertia_kg_m2) if table.knows_inertia else None,
        )

    def navigation(self, exposure: Exposure, run: int) -> ChaserState:
        """Return what the chaser believes of its own orbit at an exposure."""
        table = self.table.onboard
        return corrupted(
            self.tumble.chaser_state(exposure.time_s),
            seed=self.scenario.render.seed,
            run=run,
            frame=exposure.frame,
            sigma_m=table.chaser_sigma_m,
            sigma_m_s=table.chaser_sigma_m_s,
        )

    @property
    def exposure_share(self) -> float:
        """How much of a typed exposure time is meant.

        It is typed for the chip's own pixels: larger ones, with ``--width``, fill sooner and are
        exposed for less, so that a first look shows the same levels.
        """
        return self.scenario.pixel_scale**2

    def frame_entries(self, prior: RigidTransform | None) -> list[FrameEntry]:
        """Return the rows of ``frames.csv`` that are known before any image."""
        return [
            replace(entry, exposure_ms=entry.exposure_ms * self.exposure_share)
            for entry in super().frame_entries(prior)
        ]

    def check_poses(self) -> None:
        """Refuse a motion that nobody would see: too near, out of the image, in Earth's shadow.

        Raises
        ------
        ScenarioError
            The message names the time.
        """
        super().check_poses()
        if np.abs(self.target.centre_of_mass).max() > ON_CENTRE_M:
            raise ScenarioError(
                f"expected the origin of {self.target.name}'s frame at its centre of mass, which "
                f"lies at {self.target.centre_of_mass.tolist()} m: a free body turns about it"
            )
        for exposure in self.exposures:
            self._check_sunlit(exposure.time_s)

    def check_view(self) -> None:
        """Refuse an image without the target's centre: it is followed from each to the next.

        Raises
        ------
        ScenarioError
            The message names the time.
        """
        for exposure in self.exposures:
            self._check_seen(exposure.time_s)

    def _check_seen(self, time_s: float) -> None:
        centre = self.tumble.cam_from_target(time_s).translation
        if not self.camera.contains(np.nan_to_num(self.camera.project(centre), nan=-1e9)):
            where = ", ".join(f"{x:.2f}" for x in centre)
            raise ScenarioError(
                f"expected the target's centre in the image; at {time_s:.1f} s it is at ({where}) "
                "m in the camera's axes: change tumble.rho0_m or rho_dot0_m_s, or end the motion "
                "earlier (motion.end_s, or --span-s)"
            )

    def _check_sunlit(self, time_s: float) -> None:
        position = 1e-3 * self.tumble.chaser_state(time_s).position_in_inertial
        for name in (self.scenario.sun.default, *self.scenario.sun.shared):
            along = float(position @ sun_direction(name))
            if along < 0.0 and position @ position - along**2 < EARTH_RADIUS_KM**2:
                raise ScenarioError(
                    f"expected a Sun that the Earth does not hide, got {name}: at {time_s:.1f} s "
                    "the chaser is in its shadow; give another --sun (inertial axes), or another "
                    "tumble.orbit.true_anomaly_deg"
                )


def world_of(scenario: Scenario) -> World:
    """Return the things of a scenario: of a free target if it has ``[tumble]``, else of pairs."""
    return World(scenario) if scenario.tumble is None else TumbleWorld(scenario)
