"""The scenario's table of a free target: an orbit, a drift, a spin, and what is known on board."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from models.errors import ScenarioError
from models.lights.earth import EARTH_RADIUS_KM
from models.motion.chaser_navigation import SIGMA_M, SIGMA_M_S
from renders.scenario.frame_checks import refuse_what_has_no_effect
from renders.scenario.table import Numbers, Table, Triple

if TYPE_CHECKING:
    from renders.scenario.scenario import Scenario

Angle = Annotated[float, Field(ge=-3600, le=3600)]
Speed = Annotated[float, Field(ge=-1000, le=1000)]
Rate = Annotated[float, Field(ge=-360, le=360)]
Moment = Annotated[float, Field(ge=-1e9, le=1e9)]
Moments = Annotated[tuple[Moment, Moment, Moment], Field(strict=False)]
UNIT_TOLERANCE = 1e-3  # a quaternion typed with four digits is one
NO_EFFECT: dict[str, tuple[str, ...] | None] = {
    "lamps": None,
    "retroreflector": None,
    "prior": None,
    "motion": ("pair_gap_ms", "target_wobble"),
    "earth": ("direction", "orbit_radius_km"),
    "render": ("marker_samples",),
    "exposure": ("marker_fill",),
    "stars": ("zenith_right_ascension_deg", "q_target_from_icrs_wxyz", "rate_in_target_deg_h"),
}
"""Tables, or keys of them, that shape image pairs alone: typed with [tumble] they would mislead."""


class OrbitTable(Table):
    """An orbit by its elements; see ``models.motion.kepler_orbit``."""

    a_km: float = Field(gt=6478.137, le=1e6, description="semi-major axis")
    e: float = Field(0.0, ge=0, le=0.99, description="eccentricity")
    i_deg: float = Field(0.0, ge=0, le=180, description="inclination")
    raan_deg: Angle = Field(0.0, description="right ascension of the ascending node")
    argument_of_perigee_deg: Angle = Field(0.0, description="from the ascending node")
    true_anomaly_deg: Angle = Field(0.0, description="at time zero")


class OnboardTable(Table):
    """What is known before flight; see ``models.uncooperative.UncooperativeKnowledge``."""

    sigma_px: float = Field(
        1.0, ge=1e-3, le=1000, description="1-sigma of a corner, per axis, as expected"
    )
    chaser_sigma_m: float = Field(
        SIGMA_M, ge=0, le=1e6, description="per axis, of its own navigation"
    )
    chaser_sigma_m_s: float = Field(
        SIGMA_M_S, ge=0, le=1000, description="per axis, of its own navigation"
    )
    knows_inertia: bool = Field(True, description="whether the filters get the target's inertia")
    range_m: Numbers = Field((), description="nearest and farthest, if any is known")
    sun_sigma_deg: float | None = Field(
        None,
        ge=0,
        le=180,
        description="per axis, of the Sun's direction on board, drawn in every run; left out, the "
        "Sun is not told, and starts know nothing of it; where it is, so is whether the Earth "
        "shines",
    )
    finish_sigma: float | None = Field(
        None,
        ge=0,
        le=2,
        description="of each material's reflectance on board, as a share, log-normal, drawn in "
        "every run; left out, what the target is made of is not told",
    )
    white_sigma: float | None = Field(
        None,
        ge=0,
        le=2,
        description="likewise of what a white surface in the Sun gives the camera; left out, it is "
        "not told",
    )
    knows_target: bool | None = Field(
        None,
        description="false: neither its shape nor its inertia is on board, to be found in flight",
    )


class TumbleTable(Table):
    """A target that turns freely, seen by a chaser that keeps to its local frame.

    The local frame (LVLH) is x away from Earth, y along track, z along the orbit's normal; the
    camera looks along +y, image down is nadir. The inertial frame in which the orbit and the Sun
    are given has the axes of the ICRS: there stand the stars. See ``models.motion.tumble``.
    """

    orbit: OrbitTable = Field(description="the chaser's")
    rho0_m: Triple = Field(description="chaser to target at time zero, local frame")
    rho_dot0_m_s: Annotated[tuple[Speed, Speed, Speed], Field(strict=False)] = Field(
        (0.0, 0.0, 0.0), description="its rate in the turning frame"
    )
    omega0_deg_s: Annotated[tuple[Rate, Rate, Rate], Field(strict=False)] = Field(
        description="inertial rate of the target, in target axes"
    )
    inertia_kg_m2: Annotated[tuple[Moments, Moments, Moments], Field(strict=False)] = Field(
        description="of the target, its axes; of one of your own its file's, unless typed"
    )
    q_lvlh_from_target_wxyz: Numbers = Field(
        (1.0, 0.0, 0.0, 0.0), description="attitude at time zero, scalar first"
    )
    onboard: OnboardTable = OnboardTable()  # type: ignore[call-arg]


def check_tumble(scenario: Scenario, where: str) -> None:
    """Refuse what would not do what it says: a table of image pairs, an orbit through the Earth.

    Raises
    ------
    ScenarioError
        The message names the key.
    """
    table = scenario.tumble
    if table is None:
        return
    refuse_what_has_no_effect(scenario, NO_EFFECT, "[tumble]", where)
    if scenario.exposure.mode == "schedule" and not scenario.exposure.schedule_ms:
        raise ScenarioError(
            f"{where}: expected exposure.mode, with [tumble], as auto or fixed, or as schedule "
            "with exposure.schedule_ms = [[time_s, exposure_ms], ...]; got 'schedule' without, "
            "which reckons with markers"
        )
    perigee_km = table.orbit.a_km * (1.0 - table.orbit.e)
    if perigee_km <= EARTH_RADIUS_KM:
        raise ScenarioError(
            f"{where}: expected tumble.orbit.a_km and e of an orbit outside the Earth, "
            f"{EARTH_RADIUS_KM:g} km, got one with its perigee at {perigee_km:g} km"
        )
    wxyz = np.array(table.q_lvlh_from_target_wxyz)
    if wxyz.shape != (4,) or abs(np.linalg.norm(wxyz) - 1.0) > UNIT_TOLERANCE:
        raise ScenarioError(
            f"{where}: expected tumble.q_lvlh_from_target_wxyz of four numbers and length 1, "
            f"scalar first, got {list(table.q_lvlh_from_target_wxyz)}"
        )
    inertia = np.array(table.inertia_kg_m2)
    moments = np.linalg.eigvalsh(0.5 * (inertia + inertia.T))
    if not np.allclose(inertia, inertia.T) or moments[0] <= 0 or moments[2] > moments[:2].sum():
        raise ScenarioError(
            f"{where}: expected tumble.inertia_kg_m2 as a body's: symmetric, its principal moments "
            "above zero and the largest at most the sum of the others; "
            f"got moments {moments.tolist()}"
        )
    _check_light(table.onboard, where)
    span = table.onboard.range_m
    if span and not (len(span) == 2 and 0.0 < span[0] <= span[1]):
        raise ScenarioError(
            f"{where}: expected tumble.onboard.range_m as nearest and farthest, m, "
            f"got {list(span)}; leave it out where none is known"
        )


def _check_light(table: OnboardTable, where: str) -> None:
    """Refuse to tell of the light what nobody could use."""
    for key in ("finish_sigma", "white_sigma"):
        value = getattr(table, key)
        if value is None:
            continue
        if table.sun_sigma_deg is None:
            raise ScenarioError(
                f"{where}: expected tumble.onboard.{key} to be left out where the Sun is not told, "
                f"got {value:g}; give sun_sigma_deg too"
            )
        if key == "finish_sigma" and table.knows_target is False:
            raise ScenarioError(
                f"{where}: expected tumble.onboard.finish_sigma to be left out where "
                f"knows_target is false, got {value:g}"
            )
