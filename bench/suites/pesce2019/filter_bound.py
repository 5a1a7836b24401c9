"""The bound that no filter of a tumbling target's poses can beat, on average.

**Idea.** The motion is deterministic, so all that is known at a time is the information of every
image so far, carried along (the recursive Cramer-Rao bound of Tichavsky, Muravchik and Nehorai
1998, without process noise). An image's own information is the Cramer-Rao bound of its pose from
all landmarks with the noise as it is; outliers carry none. Motion carries it by the transition of
Yamanaka and Ankersen and by Euler's equation linearised about the true tumble.

Whoever knows less (the target's inertia, the chaser's orbit, which point is which) does worse: the
bound holds for them too, and is not reached.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from bench.scoring.pairs.cramer_rao import pose_bound
from bench.suites.pesce2019.cases import Case, tumble_of
from bench.suites.pesce2019.start_errors import StartErrors
from bench.suites.units import Outcome
from models.arrays import Floats
from models.camera import Camera, camera_preset
from models.motion.tumble import CAM_FROM_LVLH, Tumble
from models.motion.yamanaka_ankersen import state_transition
from models.pose import RigidTransform
from models.spacecraft.wireframes import wireframe_by_name
from models.wireframe.wireframe import Wireframe

START_M_S, START_DEG_S = 0.02, 2.0  # 1 sigma per axis of rates that nobody has seen yet
RHO, RHO_DOT, TURN, OMEGA = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12)


@dataclass(frozen=True)
class BoundTask:
    """What shapes a bound.

    Attributes
    ----------
    case : Case
    camera : str
        A preset.
    sigma_px : float, px
    start : StartErrors
    frames : int
    rate_hz : float
    """

    case: Case
    camera: str
    sigma_px: float
    start: StartErrors
    frames: int
    rate_hz: float


def bound(task: BoundTask) -> Outcome:
    """Return the bound's roots of trace, frame by frame.

    Returns
    -------
    Outcome
        ``raw_position_m``, ``raw_attitude_deg``: of a pose from one image. ``position_m``,
        ``velocity_m_s``, ``attitude_deg``, ``rate_deg_s``: of a state from all images so far.
        Each (frames,) float32.
    """
    began = time.perf_counter()
    tumble = tumble_of(task.case, max(1.0, (task.frames - 1) / task.rate_hz))
    target, camera = wireframe_by_name(task.case.target), camera_preset(task.camera)
    covariance = _start(task.start)
    rows = []
    for frame in range(task.frames):
        now_s = frame / task.rate_hz
        if frame > 0:
            step = transition(tumble, now_s - 1.0 / task.rate_hz, now_s)
            covariance = step @ covariance @ step.T
        seen = pose_information(tumble, target, camera, task.sigma_px, now_s)
        covariance = _updated(covariance, seen)
        single: Floats = np.asarray(np.linalg.inv(seen), dtype=np.float64)
        rates = _relative_rate(tumble, now_s) @ covariance[6:, 6:] @ _relative_rate(tumble, now_s).T
        rows.append(
            [
                _size(single[:3, :3]),
                np.rad2deg(_size(single[3:, 3:])),
                _size(covariance[RHO, RHO]),
                _size(covariance[RHO_DOT, RHO_DOT]),
                np.rad2deg(_size(covariance[TURN, TURN])),
                np.rad2deg(_size(rates)),
            ]
        )
    names = (
        "raw_position_m", "raw_attitude_deg", "position_m", "velocity_m_s", "attitude_deg",
        "rate_deg_s",
    )  # fmt: skip
    table = np.array(rows, dtype=np.float32)
    spent_s = np.array([time.perf_counter() - began])
    return Outcome({name: table[:, place] for place, name in enumerate(names)}, spent_s)


def pose_information(
    tumble: Tumble, target: Wireframe, camera: Camera, sigma_px: float, time_s: float
) -> Floats:
    """Return (6, 6): what one image tells of position (local frame) and turn (target axes).

    Parameters
    ----------
    tumble : Tumble
    target : Wireframe
    camera : Camera
    sigma_px : float, px
        1 sigma of a corner on each axis.
    time_s : float, s
    """
    pose: RigidTransform = tumble.cam_from_target(time_s, CAM_FROM_LVLH)
    smallest = pose_bound(camera, target.points_in_target, pose, [sigma_px, sigma_px])
    if smallest is None:
        return np.zeros((6, 6))
    own_axes = np.zeros((6, 6))  # from (rho, turn) to (turn in cam, position in cam)
    own_axes[:3, 3:] = pose.rotation
    own_axes[3:, :3] = CAM_FROM_LVLH.rotation
    return np.asarray(own_axes.T @ np.linalg.inv(smallest) @ own_axes, dtype=np.float64)


def transition(tumble: Tumble, from_s: float, to_s: float) -> Floats:
    """Return the (12, 12) matrix that carries small errors of (rho, rho_dot, turn, inertial rate).

    The turn is in target axes, ``R_true = R exp([turn]x)``; the rate is the inertial one.

    Parameters
    ----------
    tumble : Tumble
    from_s, to_s : float, s
    """
    carried = np.zeros((12, 12))
    carried[:6, :6] = state_transition(tumble.orbit, from_s, to_s)
    spin = inertial_rate(tumble, 0.5 * (from_s + to_s))
    inertia = tumble.inertia_kg_m2
    flow = np.zeros((6, 6))
    flow[:3, :3] = -_cross(spin)
    flow[:3, 3:] = np.eye(3)
    flow[3:, 3:] = np.linalg.solve(inertia, _cross(inertia @ spin) - _cross(spin) @ inertia)
    carried[6:, 6:] = expm((to_s - from_s) * flow)
    return carried


def inertial_rate(tumble: Tumble, time_s: float) -> Floats:
    """Return the target's inertial rate in its own axes, (3,) rad/s."""
    state = tumble.state(time_s)
    spin_of_lvlh = np.array([0.0, 0.0, tumble.orbit.anomaly_rate(time_s)])
    return np.asarray(
        state.omega_target_wrt_lvlh_in_target + state.R_lvlh_from_target.T @ spin_of_lvlh
    )


def _relative_rate(tumble: Tumble, time_s: float) -> Floats:
    """Return (3, 6): from (turn, inertial rate) to the rate with respect to the local frame."""
    attitude = tumble.state(time_s).R_lvlh_from_target
    spin_of_lvlh = np.array([0.0, 0.0, tumble.orbit.anomaly_rate(time_s)])
    return np.concatenate([-_cross(attitude.T @ spin_of_lvlh), np.eye(3)], axis=1)


def _start(errors: StartErrors) -> Floats:
    sigmas = np.repeat([errors.sigma_m, START_M_S, errors.sigma_rad, np.deg2rad(START_DEG_S)], 3)
    return np.diag(sigmas**2)


def _updated(covariance: Floats, seen: Floats) -> Floats:
    """Return the covariance after an image; its form keeps it symmetric and positive."""
    measured = np.zeros((6, 12))
    measured[:3, RHO] = np.eye(3)
    measured[3:, TURN] = np.eye(3)
    root = np.linalg.cholesky(seen + 1e-12 * np.trace(seen) * np.eye(6)).T @ measured
    spread = np.eye(6) + root @ covariance @ root.T
    gain = np.linalg.solve(spread, root @ covariance).T
    kept = np.eye(12) - gain @ root
    return np.asarray(kept @ covariance @ kept.T + gain @ gain.T, dtype=np.float64)


def _size(covariance: Floats) -> float:
    return float(np.sqrt(np.trace(covariance)))


def _cross(vector: Floats) -> Floats:
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
