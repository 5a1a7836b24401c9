"""Motions that are refused before rendering: nobody would see them, or they cannot be."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from models.errors import ScenarioError
from models.lights.earth import EARTH_RADIUS_KM
from models.spacecraft.inside import is_inside
from renders.tracing.silhouette import in_sight, pieces_of

if TYPE_CHECKING:
    from renders.world.world import World

Check: TypeAlias = "Callable[[World], None]"
ON_CENTRE_M = 1e-6  # the target frame's origin is its centre of mass


def outside_the_target(world: World) -> None:
    """Refuse a motion that takes the camera inside the target.

    Raises
    ------
    ScenarioError
        The message names the time.
    """
    for exposure in world.exposures:
        cam_from_target = world.trajectory.cam_from_target(exposure.time_s)
        place = cam_from_target.inverse().translation
        if is_inside(world.target, place):
            where = ", ".join(f"{x:.2f}" for x in place)
            raise ScenarioError(
                f"expected the camera outside the target; at {exposure.time_s:.1f} s it is at "
                f"({where}) m in the target frame, inside {world.target.name}; "
                "end the motion earlier (motion.end_s, or --span-s)"
            )


def free_about_its_centre(world: World) -> None:
    """Refuse a free target whose frame has its origin elsewhere than at the centre of mass.

    Raises
    ------
    ScenarioError
    """
    if np.abs(world.target.centre_of_mass).max() > ON_CENTRE_M:
        raise ScenarioError(
            f"expected the origin of {world.target.name}'s frame at its centre of mass, which "
            f"lies at {world.target.centre_of_mass.tolist()} m: a free body turns about it"
        )


def centre_in_image(world: World) -> None:
    """Refuse a motion that takes the target's centre out of the image.

    Raises
    ------
    ScenarioError
        The message names the time.
    """
    for exposure in world.exposures:
        centre = world.trajectory.cam_from_target(exposure.time_s).translation
        if not world.camera.contains(np.nan_to_num(world.camera.project(centre), nan=-1e9)):
            where = ", ".join(f"{x:.2f}" for x in centre)
            raise ScenarioError(
                f"expected the target's centre in the image; at {exposure.time_s:.1f} s it is at "
                f"({where}) m in the camera's axes: change tumble.rho0_m or rho_dot0_m_s, or end "
                "the motion earlier (motion.end_s, or --span-s)"
            )


def is_dark(world: World) -> bool:
    """Tell whether the Earth hides the whole of the world's Sun at some exposure."""
    return any(world.sunlit_share(exposure.time_s) <= 0.0 for exposure in world.exposures)


def lit_in_some_image(world: World) -> None:
    """Refuse a motion that lies in the Earth's shadow from end to end, and shows no light.

    Raises
    ------
    ScenarioError
    """
    for exposure in world.exposures:
        if world.lit_by(exposure):
            return
    motion = world.scenario.motion
    raise ScenarioError(
        f"expected a Sun that the Earth does not hide, got {world.scenario.sun.default}: in all "
        f"{len(world.exposures)} images, from {motion.start_s:g} to {motion.end_s:g} s, the target "
        "is in the Earth's shadow; give another --sun (inertial axes), another "
        "tumble.orbit.true_anomaly_deg, or a longer motion"
    )


def shown_in_some_image(world: World) -> None:
    """Refuse a motion that shows the target in no image.

    A frame without it is one of black sky and noise, as a camera would take it.

    Raises
    ------
    ScenarioError
    """
    for exposure in world.exposures:
        cam_from_target = world.trajectory.cam_from_target(exposure.time_s)
        pieces = pieces_of(world.target, None, cam_from_target)
        if in_sight(pieces, world.camera, cam_from_target):
            return
    motion = world.scenario.motion
    raise ScenarioError(
        f"expected a motion that shows {world.target.name} in some image, got one that has it out "
        f"of view in all {len(world.exposures)}, from {motion.start_s:g} to {motion.end_s:g} s; "
        "choose other times (motion.start_s and end_s, or --span-s)"
    )


def exposed_before_the_next(world: World) -> None:
    """Refuse lamps so faint, or so far off, that planned exposures would last into the next.

    Raises
    ------
    ScenarioError
        The message names the time.
    """
    if world.scenario.exposure.mode != "schedule":
        return
    entries = world.frame_entries(world.onboard(run=0).prior)
    longest = max(entries, key=lambda entry: entry.exposure_ms)
    gap_ms = world.scenario.motion.pair_gap_ms
    if longest.exposure_ms >= gap_ms:
        raise ScenarioError(
            f"expected exposures below motion.pair_gap_ms, {gap_ms:g} ms, got one of "
            f"{longest.exposure_ms:.3g} ms at {longest.time_s:g} s, in which the lamps fill a "
            "marker to exposure.marker_fill; give more lamps.intensity_w_sr, or "
            'exposure.mode = "fixed"'
        )


def sun_not_behind_the_earth(world: World) -> None:
    """Refuse an approach on a date and at an hour at which the Earth hides the Sun.

    Raises
    ------
    ScenarioError
        The message names the time.
    """
    for exposure in world.exposures:
        sun = np.array(world.sun_at(world.sun, exposure.time_s).direction_in_target)
        down, radius_km = world.earth_at(exposure.time_s)
        ahead = float(down @ sun)
        if ahead > 0.0 and radius_km * np.sqrt(max(0.0, 1.0 - ahead**2)) < EARTH_RADIUS_KM:
            raise ScenarioError(
                f"expected a date on which the Earth does not hide the Sun; at "
                f"{exposure.time_s:.1f} s it does: give another motion.epoch_utc, or another "
                + ("orbit" if world.scenario.orbits is not None else "motion.longitude_deg")
            )
