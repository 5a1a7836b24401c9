"""Where a scenario's Sun stands: in a named direction, as a table of poses says, or by the date.

A name or a vector stands still: in target axes, or with ``[tumble]`` in the orbit's inertial frame.
``table`` is each row's own; ``epoch`` follows from ``motion.epoch_utc``, in that inertial frame, or
over an approach from how its Earth-pointing target stands among the stars.
"""

from __future__ import annotations

from datetime import datetime
from typing import TYPE_CHECKING

from models.errors import ScenarioError
from models.lights.sun import NAMED_SUNS, sun_direction
from models.sky.sun_ephemeris import epoch_of
from renders.scenario.motion_choice import motion_kind_of, table_motion_of

if TYPE_CHECKING:
    from renders.scenario.scenario import Scenario

TABLE, EPOCH = "table", "epoch"


def epoch_in(scenario: Scenario) -> datetime:
    """Return the date of motion time 0.

    Raises
    ------
    ScenarioError
        If there is none, or it cannot be.
    """
    if scenario.motion.epoch_utc is None:
        raise ScenarioError(
            'expected motion.epoch_utc, such as "2026-03-20T12:00:00Z", with a Sun by the epoch, '
            "got none"
        )
    try:
        return epoch_of(scenario.motion.epoch_utc)
    except ScenarioError as error:
        raise ScenarioError(f"motion.epoch_utc: {error}") from error


def _check_longitude(scenario: Scenario, where: str) -> None:
    motion = scenario.motion
    if motion.longitude_deg is None:
        return
    if motion_kind_of(scenario) != "approach" or motion.epoch_utc is None:
        raise ScenarioError(
            f"{where}: expected motion.longitude_deg with an approach and motion.epoch_utc, got "
            + ("no epoch" if motion.epoch_utc is None else f'motion.kind = "{motion.kind}"')
        )
    for key in ("zenith_right_ascension_deg", "q_target_from_icrs_wxyz"):
        if getattr(scenario.stars, key) != type(scenario.stars).model_fields[key].default:
            raise ScenarioError(
                f"{where}: expected stars.{key} to be left out with motion.longitude_deg, from "
                f"which it follows, got {getattr(scenario.stars, key)!r}"
            )


def check_suns(scenario: Scenario, where: str) -> None:
    """Refuse a Sun that is none, or none of this scenario's.

    Raises
    ------
    ScenarioError
        The message names the key.
    """
    kind, default = motion_kind_of(scenario), scenario.sun.default
    if scenario.motion.epoch_utc is not None or default == EPOCH:
        try:
            epoch_in(scenario)
        except ScenarioError as error:
            raise ScenarioError(f"{where}: {error}") from error
    if default == TABLE and (
        kind != "poses" or table_motion_of(scenario).table.sun_dirs_in_target is None
    ):
        raise ScenarioError(
            f"{where}: expected a table of poses with sun_x, sun_y and sun_z for sun.default = "
            f'"{TABLE}", got none'
        )
    if default == EPOCH and kind == "poses":
        raise ScenarioError(
            f"{where}: expected [tumble] or an approach, whose orbits know the inertial axes, for "
            f'sun.default = "{EPOCH}", got motion.kind = "{kind}"'
        )
    _check_longitude(scenario, where)
    if len(scenario.sun.shared) and default in (TABLE, EPOCH):
        raise ScenarioError(
            f'{where}: expected no sun.shared with sun.default = "{default}", a Sun that moves, '
            f"got {', '.join(scenario.sun.shared)}"
        )
    for key, name in [("default", default), *(("shared", name) for name in scenario.sun.shared)]:
        if key == "default" and name in (TABLE, EPOCH):
            continue
        if kind == "tumble" and name.strip().upper() in NAMED_SUNS:
            raise ScenarioError(
                f"{where}: expected sun.default, with [tumble], as a vector x,y,z towards the Sun "
                f"in the inertial frame of the orbit, got {name!r}, which stands in target axes; "
                f'give one such as "0.3,-0.5,1", or "{EPOCH}"'
            )
        sun_direction(name)
