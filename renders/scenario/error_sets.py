"""Errors that a mission would have, as named sets: each alone, those of a paper, and all together.

A set takes the place of a scenario's tables ``[prior]``, ``[calibration]``, ``[drift]`` and, but
for ``target``, ``mount`` and ``arm``, ``[told]``. Every error is a draw that run and quantity key,
so a draw is the same in each set that has it, and the pipeline is told its sigma.

Levels are those of Opromolla et al. 2022 where it has them (Tables 5, 8, 9 and 10), in pixels of
its 2048; the others are ours: what is left after calibration on ground and a launch.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

from models.errors import ScenarioError
from models.motion.prior import (
    CHASER_FIXED_SIGMA_DEG,
    CHASER_FIXED_SIGMA_M,
    EYE_IN_HAND_SIGMA_DEG,
    EYE_IN_HAND_SIGMA_M,
)
from renders.scenario.drift_table import DriftTable
from renders.scenario.told_tables import (
    CalibrationTable,
    Difference,
    PriorTable,
    ToldCameraTable,
    ToldClockTable,
    ToldDetectorTable,
    ToldMarkersTable,
    ToldOpticsTable,
    ToldTable,
    VectorDifference,
)

if TYPE_CHECKING:
    from renders.scenario.scenario import Scenario

ErrorSetName: TypeAlias = Literal[
    "none", "prior", "intrinsics", "distortion", "blur", "detector", "marker_places",
    "marker_radius", "marker_tilt", "lamps", "vignetting", "clock", "mount", "table5", "table8",
    "table9_c1", "table9_c2", "table10", "realistic", "realistic_prior4",
]  # fmt: skip
ALMOST = 0.05  # of Table 5's prior: a first pose that is known, and that a pipeline can weigh
INSTALLED_M = {"pairs": 1e-3, "colour": 3e-4}  # Table 10
RADIUS_M = {"pairs": 0.0127, "colour": 0.01}  # sections 3.1 and 3.2
GAIN, READ_NOISE, BIAS_DN = 0.05, 0.1, 2.0


AS_IT_WAS = DriftTable()  # type: ignore[call-arg]


@dataclass(frozen=True)
class ErrorSet:
    """1-sigmas of what is wrong in a run; 0 is exact.

    Attributes
    ----------
    prior : float
        Of the first pose, in Table 5's sigmas.
    intrinsics_px : float, px
        Of fx, fy, cx and cy, in pixels of the paper's 2048.
    radial, tangential : float
        Of k1 and k2, and of p1 and p2: about 0.1 px each in a corner of the image.
    drift : DriftTable
        Of lamps and lens, as shares.
    detector : float
        Of 5 % of the gain, 10 % of the read noise and 2 DN of the bias.
    installed : float
        Of the markers' places, in Table 10's sigmas.
    radius : float
        Of the markers' radius, as a share.
    tilt_deg : float, deg
        Of the markers' normals.
    clock_s : float, s
        Of the time that is stamped on a frame.
    mount_deg, mount_m : float, deg and m
        Of the camera's mount on what carries it: the pose of that body is wrong by it, too.
    """

    prior: float = ALMOST
    intrinsics_px: float = 0.0
    radial: float = 0.0
    tangential: float = 0.0
    drift: DriftTable = AS_IT_WAS
    detector: float = 0.0
    installed: float = 0.0
    radius: float = 0.0
    tilt_deg: float = 0.0
    clock_s: float = 0.0
    mount_deg: float = 0.0
    mount_m: float = 0.0


def _drift(**shares: float) -> DriftTable:
    return DriftTable(**shares)


ALONE = {
    "none": ErrorSet(),
    "prior": ErrorSet(prior=1.0),
    "intrinsics": ErrorSet(intrinsics_px=1.0),
    "distortion": ErrorSet(radial=5e-4, tangential=1e-4),
    "blur": ErrorSet(drift=_drift(blur=0.2, blur_over_field=0.2)),
    "detector": ErrorSet(detector=1.0),
    "marker_places": ErrorSet(installed=1.0),
    "marker_radius": ErrorSet(radius=0.01),
    "marker_tilt": ErrorSet(tilt_deg=1.0),
    "lamps": ErrorSet(drift=_drift(lamp_power=0.1, lamp_tilt=0.1)),
    "vignetting": ErrorSet(drift=_drift(vignetting=0.05)),
    "clock": ErrorSet(clock_s=2e-3),
    "mount": ErrorSet(mount_deg=0.05, mount_m=1e-3),
}
"""Each error by itself."""


def _together() -> ErrorSet:
    plain, drift = ErrorSet(), dict[str, float]()
    found: dict[str, Any] = {}
    for own in ALONE.values():
        drift |= {key: share for key, share in own.drift.model_dump().items() if share}
        for field in fields(ErrorSet):
            if field.name != "drift" and getattr(own, field.name) != getattr(plain, field.name):
                found[field.name] = getattr(own, field.name)
    return ErrorSet(**found, drift=_drift(**drift))


TABLE_5 = ErrorSet(prior=1.0, intrinsics_px=1.0)
ERROR_SETS: dict[str, ErrorSet] = {
    **ALONE,
    "table5": TABLE_5,
    "table8": replace(TABLE_5, prior=2.0),
    "table9_c1": replace(TABLE_5, intrinsics_px=2.0),
    "table9_c2": replace(TABLE_5, intrinsics_px=3.0),
    "table10": replace(TABLE_5, installed=1.0),
    "realistic": _together(),
    "realistic_prior4": replace(_together(), prior=4.0),
}
"""All of them, by name."""


def check_error_set(scenario: Scenario, where: str) -> None:
    """Refuse named errors where there are no markers that they could be of.

    Raises
    ------
    ScenarioError
    """
    if scenario.errors is not None and scenario.frame_kind not in INSTALLED_M:
        raise ScenarioError(
            f"{where}: expected errors = {scenario.errors!r} only with image pairs or colour "
            f"images of markers, got {scenario.frame_kind} images; type [told] instead"
        )


def with_error_set(scenario: Scenario, name: str) -> Scenario:
    """Return a scenario under the errors of a set; see the module's text.

    Parameters
    ----------
    scenario : Scenario
    name : str
        Of ``ERROR_SETS``.
    """
    own = ERROR_SETS[name]
    kind = "colour" if scenario.frame_kind == "colour" else "pairs"
    drifting = own.drift != AS_IT_WAS
    changes = {
        "errors": name,
        "prior": _prior(own, kind, scenario.prior),
        "calibration": CalibrationTable(
            sigma_focal_px=own.intrinsics_px * scenario.pixel_scale,
            sigma_principal_point_px=own.intrinsics_px * scenario.pixel_scale,
        ),
        "told": _told(own, kind, scenario),
        "drift": own.drift if drifting else None,
    }
    return scenario.model_copy(update=changes)


def _prior(own: ErrorSet, kind: str, before: PriorTable) -> PriorTable:
    lengths, angles = {
        "pairs": (CHASER_FIXED_SIGMA_M, CHASER_FIXED_SIGMA_DEG),
        "colour": (EYE_IN_HAND_SIGMA_M, EYE_IN_HAND_SIGMA_DEG),
    }[kind if before.by is None else "pairs"]
    x, y, z = (own.prior * np.array(lengths)).tolist()
    alpha, beta, gamma = (own.prior * np.array(angles)).tolist()
    return PriorTable(by=before.by, sigma_t_m=(x, y, z), sigma_euler_deg=(alpha, beta, gamma))


def _told(own: ErrorSet, kind: str, scenario: Scenario) -> ToldTable:
    before = scenario.told
    detector = scenario.simulated_detector
    of_detector = {
        "gain_e_dn": GAIN * detector.gain_e_dn,
        "bias_dn": BIAS_DN,
        "read_noise_e": READ_NOISE * detector.read_noise_e,
    }
    of_camera = {"k1": own.radial, "k2": own.radial, "p1": own.tangential, "p2": own.tangential}
    markers: dict[str, Any] = {}
    if own.installed:
        markers["place_m"] = _each(own.installed * INSTALLED_M[kind])
    if own.tilt_deg:
        markers["normal_deg"] = _each(own.tilt_deg)
    if own.radius:
        markers["radius_m"] = _one(own.radius * RADIUS_M[kind])
    return ToldTable(
        camera=ToldCameraTable(**{key: _one(s) for key, s in of_camera.items()})
        if own.radial or own.tangential
        else None,
        optics=ToldOpticsTable(),  # type: ignore[call-arg]
        detector=ToldDetectorTable(
            **{key: _one(own.detector * s) for key, s in of_detector.items()}
        )
        if own.detector
        else None,
        markers=ToldMarkersTable(**markers) if markers else None,
        clock=ToldClockTable(offset_s=_one(own.clock_s), drift_ppm=None) if own.clock_s else None,
        target=None if before is None else before.target,
        mount=None if before is None else before.mount,
        arm=None if before is None else before.arm,
    )


def _one(sigma: float) -> Difference:
    return Difference(sigma=sigma)  # type: ignore[call-arg]


def _each(sigma: float) -> VectorDifference:
    return VectorDifference(sigma=sigma)  # type: ignore[call-arg]
