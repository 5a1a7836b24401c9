"""What a pipeline says of a target's shape and mass, whichever variant it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats, Mask
from models.motion.boresight_pointing import HILL_FROM_LVLH
from pipelines.unknown_target.batch_solution import BatchSolution
from pipelines.unknown_target.paper_dynamics import PaperState
from pipelines.unknown_target.paper_filter import PaperEstimate


@dataclass(frozen=True, eq=False)
class TargetEstimate:
    """A target at one time, as far as it is known.

    Attributes
    ----------
    rho_in_lvlh, rho_dot_in_lvlh : (3,) array, m and m/s
        From the target's centre of mass to the chaser, in the target's local frame.
    R_cam_from_target : (3, 3) array
    omega_in_target : (3,) array, rad/s
        Inertial rate, body axes.
    covariance : (12, 12) array
        Of rho, its rate, the turn in body axes (rad) and the rate.
    names : tuple of int
        The track of each point.
    points_in_target : (n, 3) array, m
        From the centre of mass, body axes: those of the first camera.
    inertia : (3, 3) array
        Of trace 1.
    sigma_m : (n,) array or None, m
        Of each point, the root of its covariance's trace; None where it is not asked.
    shape_sigma_m : float, m
        Of points that are part of the shape at most.
    inertia_kg_m2 : (3, 3) array or None
        With the scale that ``paper`` believes in.
    lost_inertia_ratios : int or None
        How many of the five ratios the motion has told nothing of; None where nobody asks.
    scale_lost : bool or None
        Whether no range has told the geometric scale.
    """

    rho_in_lvlh: Floats
    rho_dot_in_lvlh: Floats
    R_cam_from_target: Floats
    omega_in_target: Floats
    covariance: Floats
    names: tuple[int, ...]
    points_in_target: Floats
    inertia: Floats
    inertia_kg_m2: Floats | None = None
    lost_inertia_ratios: int | None = None
    scale_lost: bool | None = None
    sigma_m: Floats | None = None
    shape_sigma_m: float = float(np.inf)

    @property
    def of_shape(self) -> Mask:
        """(n,) bool array: the points that are known well enough to tell the shape."""
        if self.sigma_m is None:
            return np.ones(len(self.names), dtype=bool)
        return np.asarray(self.sigma_m < self.shape_sigma_m)


def of_batch(solution: BatchSolution) -> TargetEstimate:
    """Return what ``best`` says, of points that it knows well enough for the shape."""
    live = np.flatnonzero(solution.live & (solution.point_sigmas < solution.most_sigma_m))
    return TargetEstimate(
        solution.motion[:3],
        solution.motion[3:6],
        solution.placed.R_cam_from_target[0],
        solution.motion[6:],
        solution.motion_covariance,
        tuple(solution.names[place] for place in live),
        solution.unknowns.points[live],
        solution.inertia,
        None,
        solution.lost_inertia_ratios,
        solution.scale_lost,
        solution.point_sigmas[live],
        solution.shape_sigma_m,
    )


def of_filter(estimate: PaperEstimate) -> TargetEstimate:
    """Return what ``paper`` says; a quaternion's spread is that of half a turn."""
    state, layout = estimate.state, estimate.layout
    xx, yy, zz, xy, xz, yz = state[layout.inertia]
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return TargetEstimate(
        HILL_FROM_LVLH.T @ state[layout.rho],
        HILL_FROM_LVLH.T @ state[layout.rho_dot],
        Rotation.from_quat(state[layout.quaternion]).as_matrix(),
        state[layout.omega],
        _motion_covariance(estimate.covariance, state, layout),
        estimate.names,
        state[layout.from_centre].reshape(-1, 3),
        inertia / np.trace(inertia),
        inertia,
    )


def _motion_covariance(covariance: Floats, state: Floats, layout: PaperState) -> Floats:
    by_state = np.zeros((12, layout.size))
    by_state[0:3, layout.rho] = by_state[3:6, layout.rho_dot] = HILL_FROM_LVLH.T
    x, y, z, w = state[layout.quaternion]
    by_state[6:9, layout.quaternion] = 2.0 * np.array(
        [[w, z, -y, -x], [-z, w, x, -y], [y, -x, w, -z]]
    )
    by_state[9:12, layout.omega] = np.eye(3)
    return np.asarray(by_state @ covariance @ by_state.T)
