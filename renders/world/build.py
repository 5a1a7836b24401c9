"""Which parts a scenario's world is composed of."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from models.errors import ScenarioError
from models.materials import BLACK, BandReflectance
from models.motion.approach import Approach
from models.motion.table_motion import Stills, TableMotion
from models.motion.tumble import CAM_FROM_LVLH
from models.onboard import FlightExpectations
from models.sensors.range_finder import RangeFinder
from models.sky.sun_ephemeris import right_ascension_over
from models.spacecraft.armed_chaser import armed_chaser
from models.spacecraft.catalogue import spacecraft_by_name
from models.spacecraft.in_colour import in_colour
from models.spacecraft.own_markers import with_own_markers
from models.spacecraft.part import Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.scenario.marker_tables import markers_from
from renders.scenario.motion_choice import table_motion_of
from renders.scenario.own_target import target_of, wireframe_if_any, wireframe_of
from renders.scenario.scenario import Scenario
from renders.scenario.sky_tables import StarsTable
from renders.scenario.sun_choice import EPOCH, epoch_in
from renders.scenario.surface_tables import with_surfaces
from renders.scenario.tumble_tables import TumbleTable
from renders.truth.makers import OfLandmarks, OfMarkers, OfPoses, TruthMaker
from renders.world.arm_aboard import ArmAboard, CarriedCamera, Moved
from renders.world.arm_clear import clear_of_everything
from renders.world.arm_planned import arm_aboard
from renders.world.arm_told import FirstPoseByArm, JointReadings, ToldArm
from renders.world.bodies import Bodies
from renders.world.cameras import ImagingSensor, colour_camera, pair_camera, single_camera
from renders.world.checks import (
    Check,
    centre_in_image,
    exposed_before_the_next,
    free_about_its_centre,
    lit_in_some_image,
    outside_the_target,
    shown_in_some_image,
    sun_not_behind_the_earth,
)
from renders.world.exposure_plan import (
    ExposurePlan,
    FillOfMarkers,
    OfTable,
    Planned,
    TypedSchedule,
)
from renders.world.free_motion import chaser_tables, free_motion, own_navigation
from renders.world.moving_sun import inertial_sun, with_its_sun
from renders.world.onboard import BeforeFlight, FirstPose
from renders.world.orbit_pair import OverAnOrbit, two_orbits
from renders.world.own_navigation import SensorsAboard
from renders.world.range_readings import RangeReadings
from renders.world.sky import FixedInTarget, Sky, Turning, TurningWithOrbit, sun_group
from renders.world.table_sensors import TableSensor
from renders.world.told_light import ToldLight
from renders.world.trajectory import FreeMotion, Trajectory
from renders.world.world import World

PAIRS, TUMBLES, POSED, DOTS = "retroreflector_pairs", "tumble_images", "posed_images", "dot_images"
UNKNOWN, NAVIGATED = "unknown_images", "navigated_images"


def world_of(scenario: Scenario) -> World:
    """Compose the things of a scenario: what moves, and what a frame of it is."""
    if scenario.tumble is not None:
        return _tumble(scenario, scenario.tumble)
    composed = {"pairs": _pairs, "single": _singles, "colour": _in_colour}
    return composed[scenario.frame_kind](scenario)


def _pairs(scenario: Scenario) -> World:
    """Image pairs of a target with markers, under a sky that stands still over it."""
    moving = _moving(scenario)
    bodies = _bodies(scenario, moving, has_chaser=True)
    world = _posed(scenario, moving, bodies, pair_camera(scenario), OfMarkers(), 1.0)
    known = replace(world.before_flight, marked=bodies, first_pose=_first_pose(scenario, moving))
    checks = (outside_the_target, shown_in_some_image, exposed_before_the_next, *moving.checks)
    return replace(world, chain=PAIRS, before_flight=known, checks=checks)


def _singles(scenario: Scenario) -> World:
    """Single images of a target, as it is met; nothing is known on board of where it is."""
    moving, wireframe = _moving(scenario), wireframe_if_any(scenario)
    bodies, share = _bodies(scenario, moving), scenario.pixel_scale**2
    truth = OfPoses(wireframe)
    world = _posed(scenario, moving, bodies, single_camera(scenario), truth, share)
    return replace(world, before_flight=replace(world.before_flight, wireframe=wireframe))


def _in_colour(scenario: Scenario) -> World:
    """Single images in colour of white dots, from a first pose; a chaser with an arm is there."""
    moving, share = _moving(scenario), scenario.pixel_scale**2
    bodies = Bodies(
        make_target=partial(_dotted_in_colour, scenario),
        optics=RetroreflectorOptics(returned=BLACK),
        make_chaser=None if moving.arm is None else partial(_chaser_in_colour, moving.arm),
    )
    world = _posed(scenario, moving, bodies, colour_camera(scenario), OfMarkers(), share)
    known = replace(
        world.before_flight,
        marked=bodies,
        first_pose=_first_pose(scenario, moving),
        wireframe=wireframe_if_any(scenario),
    )
    return replace(world, chain=DOTS, before_flight=known)


def _posed(
    scenario: Scenario,
    moving: Moving,
    bodies: Bodies,
    sensor: ImagingSensor,
    truth: TruthMaker,
    share: float,
) -> World:
    """Return posed images; ``share`` is what of a typed exposure time is meant."""
    return World(
        scenario=scenario,
        chain=POSED,
        bodies=bodies,
        trajectory=moving.trajectory,
        sky=_sky(scenario, moving.sky, moving.table),
        sensor=sensor,
        plan=_plan(scenario, FillOfMarkers(scenario, moving.plan, bodies.optics), share, moving),
        before_flight=BeforeFlight(
            camera=sensor.camera,
            calibration=scenario.calibration,
            detector=scenario.simulated_detector,
            psf_sigma_px=scenario.simulated_optics.psf_sigma_px,
            told=scenario.told,
            arm=moving.told_arm,
            drift=scenario.drift,
        ),
        truth=truth,
        checks=(outside_the_target, shown_in_some_image, *moving.checks),
        tables=moving.tables,
        arm=moving.arm,
    )


def _chaser_in_colour(arm: ArmAboard) -> Spacecraft:
    return in_colour(armed_chaser(arm.motion.arm, arm.hand_from_tool))


def _dotted_in_colour(scenario: Scenario) -> Spacecraft:
    target = in_colour(_target(scenario))
    if target.markers is None:
        raise ScenarioError(
            f'{scenario.name}: expected a target with markers for frame.kind = "colour", '
            f"{target.name} has none; give [markers]"
        )
    return replace(target, markers=replace(target.markers, paint="white_paint"))


def _tumble(scenario: Scenario, table: TumbleTable) -> World:
    """Single images of a free target, under a sky that turns over it.

    The chaser, tens of metres off, throws no shadow that reaches it and is left out.
    """
    motion = free_motion(scenario, table)
    bodies, sensor = _bodies(scenario), single_camera(scenario)
    told, known = table.onboard, table.onboard.knows_target is not False
    wireframe = wireframe_of(scenario) if known else wireframe_if_any(scenario)
    share, sky = scenario.pixel_scale**2, _sky(scenario, TurningWithOrbit(motion))
    sky = replace(sky, eclipses=True)
    navigation = own_navigation(scenario, motion)
    return World(
        scenario=scenario,
        chain=_chain(known, navigation),
        bodies=bodies,
        trajectory=motion,
        sky=sky,
        sensor=sensor,
        plan=_plan(scenario, FillOfMarkers(scenario, motion, bodies.optics), share),
        before_flight=BeforeFlight(
            camera=sensor.camera,
            calibration=scenario.calibration,
            detector=scenario.simulated_detector,
            wireframe=wireframe if known else None,
            expectations=FlightExpectations(
                cam_from_lvlh=CAM_FROM_LVLH,
                sigma_px=told.sigma_px,
                chaser_sigma_m=told.chaser_sigma_m,
                chaser_sigma_m_s=told.chaser_sigma_m_s,
                range_m=(told.range_m[0], told.range_m[1]) if told.range_m else None,
                inertia_kg_m2=(
                    np.array(table.inertia_kg_m2) if known and told.knows_inertia else None
                ),
                sun_dir_in_inertial=(
                    None
                    if told.sun_sigma_deg is None
                    else inertial_sun(scenario, sky.sun, scenario.motion.start_s)
                ),
                sun_sigma_deg=told.sun_sigma_deg or 0.0,
                earth_shines=told.sun_sigma_deg is not None and scenario.earth.shines,
                earth_hides_sun=told.sun_sigma_deg is not None and sky.eclipses,
            ),
            light=ToldLight(scenario, told, wireframe if known else None),
            psf_sigma_px=scenario.simulated_optics.psf_sigma_px,
            told=scenario.told,
            drift=scenario.drift,
            navigation=navigation,
        ),
        truth=OfLandmarks(motion, wireframe),
        checks=(outside_the_target, free_about_its_centre, centre_in_image, lit_in_some_image),
        tables=(
            *chaser_tables(scenario, table, motion, navigation),
            *_range_finder(scenario, bodies, motion),
        ),
        absolute=motion,
    )


def _chain(known: bool, navigation: SensorsAboard | None) -> str:
    if navigation is not None:
        return NAVIGATED
    return TUMBLES if known else UNKNOWN


def _range_finder(
    scenario: Scenario, bodies: Bodies, motion: FreeMotion
) -> tuple[RangeReadings, ...]:
    if scenario.range_finder is None:
        return ()
    table = scenario.range_finder.model_dump()
    footprint_rad = 1e-3 * table.pop("footprint_mrad")
    finder, rate_hz = RangeFinder(**table), scenario.motion.rate_hz
    return (RangeReadings(finder, bodies, motion, rate_hz, scenario.render.seed, footprint_rad),)


@dataclass(frozen=True, eq=False)
class Moving:
    """What moves, unless a target turns freely: an approach, or a table of poses.

    Attributes
    ----------
    trajectory, plan : Trajectory
        As it is, and as the chaser reckons with.
    sky : Turning
    table : TableMotion or None
    arm : ArmAboard or None
    told_arm : ToldArm or None
    by_date : bool
        Whether the Sun stands where the date has it.
    """

    trajectory: Trajectory
    plan: Trajectory
    sky: Turning
    table: TableMotion | None = None
    arm: ArmAboard | None = None
    told_arm: ToldArm | None = None
    by_date: bool = False

    @property
    def tables(self) -> tuple[TableSensor, ...]:
        """The arm's joints as read."""
        return () if self.told_arm is None else (JointReadings(self.told_arm),)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Whether the arm stays clear, and the Earth away from a Sun by date."""
        by_date = () if not self.by_date else (sun_not_behind_the_earth,)
        return by_date if self.arm is None else (*by_date, clear_of_everything)


def _moving(scenario: Scenario) -> Moving:
    """Return what moves, the arm with it."""
    moving = _without_arm(scenario)
    if scenario.arm is None:
        return moving
    arm = arm_aboard(scenario, scenario.arm, moving.trajectory)
    told = ToldArm(arm, None if scenario.told is None else scenario.told.arm)
    moving = replace(moving, arm=arm, told_arm=told)
    if not arm.carries_camera:
        return moving
    return replace(
        moving,
        trajectory=CarriedCamera(arm, moving.trajectory),
        plan=CarriedCamera(arm, moving.plan),
    )


def _without_arm(scenario: Scenario) -> Moving:
    if scenario.motion_kind == "poses":
        table = table_motion_of(scenario)
        return Moving(table, table, FixedInTarget(scenario.earth, scenario.stars), table)
    if scenario.orbits is not None:
        flown = two_orbits(scenario, scenario.orbits, _target(scenario))
        by_date = scenario.sun.default == EPOCH
        return Moving(flown, flown.planned, OverAnOrbit(flown), by_date=by_date)
    approach = Approach() if scenario.motion.target_wobble else Approach(pointing_accuracy_deg=0.0)
    flight_plan = replace(approach, pointing_accuracy_deg=0.0)  # the target does not sway
    sky = FixedInTarget(scenario.earth, _stars(scenario), approach.wobble)
    ring, by_date = scenario.motion.ring_in_target_m, scenario.sun.default == EPOCH
    if ring is None:
        return Moving(approach, flight_plan, sky, by_date=by_date)
    return Moving(Moved(approach, ring), Moved(flight_plan, ring), sky, by_date=by_date)


def _stars(scenario: Scenario) -> StarsTable:
    """Return how an approached target stands among the stars, typed or by date and longitude."""
    longitude_deg = scenario.motion.longitude_deg
    if longitude_deg is None:
        return scenario.stars
    zenith_deg = right_ascension_over(longitude_deg, epoch_in(scenario))
    return scenario.stars.model_copy(update={"zenith_right_ascension_deg": zenith_deg})


def _first_pose(scenario: Scenario, moving: Moving) -> FirstPose | FirstPoseByArm:
    start_s, table = scenario.times_s[0], scenario.prior
    if table.by == "arm" and moving.told_arm is not None:
        return FirstPoseByArm(moving.told_arm, start_s, table)
    return FirstPose(moving.trajectory, start_s, table)


def _target(scenario: Scenario) -> Spacecraft:
    target = target_of(scenario)
    if scenario.surface is not None:
        target = with_surfaces(target, scenario.surface, scenario.name)
    if scenario.markers is None:
        return target
    return with_own_markers(target, markers_from(scenario.markers, scenario.name))


def _bodies(scenario: Scenario, moving: Moving | None = None, has_chaser: bool = False) -> Bodies:
    """Return the target and the chaser, where that is near enough or carries an arm."""
    table = scenario.retroreflector
    make_chaser = partial(spacecraft_by_name, "chaser") if has_chaser else None
    if moving is not None and moving.arm is not None:
        make_chaser = partial(armed_chaser, moving.arm.motion.arm, moving.arm.hand_from_tool)
    return Bodies(
        make_target=partial(_target, scenario),
        optics=RetroreflectorOptics(
            half_angle_deg=table.half_angle_deg,
            returned=BandReflectance(0.0, table.returned_800, table.returned_850),
        ),
        make_chaser=make_chaser,
    )


def _sky(scenario: Scenario, turning: Turning, table: TableMotion | None = None) -> Sky:
    shared = tuple(sun_group(name) for name in scenario.sun.shared)
    rows = table if isinstance(table, Stills) else None
    return Sky(*with_its_sun(scenario, turning, table), shared, scenario.earth, rows)


def _plan(
    scenario: Scenario, unless_typed: Planned, share: float, moving: Moving | None = None
) -> ExposurePlan:
    planned, rows = unless_typed, scenario.exposure.schedule_ms
    if scenario.exposure.mode == "table" and moving is not None and moving.table is not None:
        planned = OfTable(moving.table, share)
    if rows:
        planned = TypedSchedule(
            tuple(row[0] for row in rows), tuple(row[1] * share for row in rows)
        )
    return ExposurePlan(scenario.exposure, planned, share)
