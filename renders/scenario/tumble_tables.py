"""The scenario's table of a free target: an orbit, a drift, a spin, and what is known on board."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from pydantic import Field

from models.errors import ScenarioError
from models.lights.sun import SUN_CASES_DEG, sun_direction
from models.motion.chaser_navigation import SIGMA_M, SIGMA_M_S
from renders.scenario.table import Table

if TYPE_CHECKING:
    from renders.scenario.scenario import Scenario

Triple = tuple[float, float, float]
UNIT_TOLERANCE = 1e-3  # a quaternion typed with four digits is one
NO_EFFECT = {
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
    """The chaser's orbit; see ``models.motion.kepler_orbit``."""

    a_km: float = Field(gt=6478.137, description="semi-major axis")
    e: float = Field(0.0, ge=0, lt=1)
    i_deg: float = Field(0.0, ge=0, le=180)
    raan_deg: float = 0.0
    argument_of_perigee_deg: float = 0.0
    true_anomaly_deg: float = Field(0.0, description="at time zero")


class OnboardTable(Table):
    """What is known before flight; see ``models.uncooperative.UncooperativeKnowledge``."""

    sigma_px: float = Field(1.0, gt=0, description="1-sigma of a corner, per axis, as expected")
    chaser_sigma_m: float = Field(SIGMA_M, ge=0, description="per axis, of its own navigation")
    chaser_sigma_m_s: float = Field(SIGMA_M_S, ge=0)
    knows_inertia: bool = Field(True, description="whether the filters get the target's inertia")
    range_m: tuple[float, ...] = Field((), description="nearest and farthest, if any is known")


class TumbleTable(Table):
    """A target that turns freely, seen by a chaser that keeps to its local frame.

    The local frame (LVLH) is x away from Earth, y along track, z along the orbit's normal; the
    camera looks along +y, image down is nadir. The inertial frame in which the orbit and the Sun
    are given has the axes of the ICRS: there stand the stars. See ``models.motion.tumble``.
    """

    orbit: OrbitTable
    rho0_m: Triple = Field(description="chaser to target at time zero, local frame")
    rho_dot0_m_s: Triple = Field((0.0, 0.0, 0.0), description="its rate in the turning frame")
    omega0_deg_s: Triple = Field(description="inertial rate of the target, in target axes")
    inertia_kg_m2: tuple[Triple, Triple, Triple] = Field(description="of the target, its axes")
    q_lvlh_from_target_wxyz: tuple[float, ...] = Field(
        (1.0, 0.0, 0.0, 0.0), description="attitude at time zero, scalar first"
    )
    onboard: OnboardTable = OnboardTable()  # type: ignore[call-arg]


def check_tumble(scenario: Scenario, where: str) -> None:
    """Refuse what would not do what it says: a Sun of another frame, a table of image pairs.

    Raises
    ------
    ScenarioError
        The message names the key.
    """
    table = scenario.tumble
    if table is None:
        return
    for name in (scenario.sun.default, *scenario.sun.shared):
        if name.strip().upper() in SUN_CASES_DEG:
            raise ScenarioError(
                f"{where}: expected sun.default, with [tumble], as a vector x,y,z towards the Sun "
                f"in the inertial frame of the orbit, got {name!r}, which stands in target axes; "
                'give one such as "0.3,-0.5,1"'
            )
        sun_direction(name)
    _refuse_what_has_no_effect(scenario, where)
    if scenario.exposure.mode == "schedule" and not scenario.exposure.schedule_ms:
        raise ScenarioError(
            f"{where}: expected exposure.mode, with [tumble], as auto or fixed, or as schedule "
            "with exposure.schedule_ms = [[time_s, exposure_ms], ...]; got 'schedule' without, "
            "which reckons with markers"
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
    span = table.onboard.range_m
    if span and not (len(span) == 2 and 0.0 < span[0] <= span[1]):
        raise ScenarioError(
            f"{where}: expected tumble.onboard.range_m as nearest and farthest, m, "
            f"got {list(span)}; leave it out where none is known"
        )


def _refuse_what_has_no_effect(scenario: Scenario, where: str) -> None:
    for name, keys in NO_EFFECT.items():
        table = getattr(scenario, name)
        plain = type(table)()
        for key in keys or type(table).model_fields:
            if getattr(table, key) != getattr(plain, key):
                raise ScenarioError(
                    f"{where}: expected {name}.{key} to be left out with [tumble], where it has "
                    f"no effect, got {getattr(table, key)!r}"
                )
