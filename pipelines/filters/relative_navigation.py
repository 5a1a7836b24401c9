"""The navigation filter: translation and rotation apart, fed by poses, asked for the next one.

The two work side by side, so that a poor attitude never spoils the position by which a chaser
keeps clear of its target (Pesce et al. 2019, section IV).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from models.arrays import Floats
from models.estimate import Estimate
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.relative_state import ChaserState, RelativeState
from models.pose import RigidTransform
from pipelines.filters import h_infinity, kalman, minimum_energy, multiplicative_ekf
from pipelines.filters.camera_mount import CameraMount
from pipelines.filters.covariance_fault import covariance_fault, positive
from pipelines.filters.lasting_errors import WHITE, LastingErrors
from pipelines.filters.minimum_energy import NoMinimumEnergy
from pipelines.filters.multiplicative_ekf import RotationUpdate
from pipelines.filters.navigation_options import NavigationOptions
from pipelines.filters.pose_measurement import PoseMeasurement, measured
from pipelines.filters.rotation_process import RotationProcess, turn_between
from pipelines.filters.translation_process import transition_and_noise

SAME_TIME_S = 1e-9
_POSITION_IS_SEEN = np.hstack([np.eye(3), np.zeros((3, 3))])


@dataclass(frozen=True, eq=False)
class FilteredState:
    """What the filters say at one time.

    Attributes
    ----------
    state : RelativeState
    translation_covariance : (6, 6) array, m and m/s
        Of (rho, rho_dot) in the local frame. For an H-infinity filter a bound, not a covariance.
    rotation_covariance : (6, 6) array, rad and rad/s
        Of (turn, omega) in target axes: ``R_true = R exp([turn]x)``.
    used_pose : bool
        Whether a pose of this very time is in it.
    reason : str
        Why not, where one was offered; or what had to be done about it.
    translation_nis, rotation_nis : float or None
        Of the pose offered, used or not: chi2 with three degrees of freedom each.
    refused_in_row : int
        Poses refused since the last one used: many mean that the filters are lost, not the poses.
    since_pose_s : float, s
        Since the last pose used.
    """

    state: RelativeState
    translation_covariance: Floats
    rotation_covariance: Floats
    used_pose: bool = False
    reason: str = ""
    translation_nis: float | None = None
    rotation_nis: float | None = None
    refused_in_row: int = 0
    since_pose_s: float = 0.0

    def pose_covariance(self, cam_from_lvlh: RigidTransform) -> Floats:
        """Return the (6, 6) covariance of the pose that a camera sees, as an estimate has it.

        rad and m, rotation first, camera axes; the filters know nothing between the two.
        """
        turn = cam_from_lvlh.rotation @ self.state.R_lvlh_from_target
        covariance = np.zeros((6, 6))
        covariance[:3, :3] = turn @ self.rotation_covariance[:3, :3] @ turn.T
        mount = cam_from_lvlh.rotation
        covariance[3:, 3:] = mount @ self.translation_covariance[:3, :3] @ mount.T
        return covariance


class RelativeNavigation:
    """The decoupled pair of filters; one instance follows one target.

    ``start`` or ``start_from_pose``, then for each frame ``predict``, and ``update`` where the
    frame gave a pose. Without one the filters coast.

    Parameters
    ----------
    options : NavigationOptions
    cam_from_lvlh : RigidTransform
        How the camera is mounted.
    chaser_sigma_m, chaser_sigma_m_s : float, m and m/s
        1 sigma per axis of the chaser states that ``predict`` is given.
    inertia_kg_m2 : (3, 3) array, optional
        Of the target, about its centre of mass and in its own axes, where it is known; any
        multiple serves. Only with ``rate_model = "inertial"``.
    errors : LastingErrors
        Of the poses; without it they are white.

    Raises
    ------
    ValueError
        If errors last and the filters are not Kalman's, which alone can carry them.
    """

    def __init__(
        self,
        options: NavigationOptions,
        cam_from_lvlh: RigidTransform,
        *,
        chaser_sigma_m: float = 0.0,
        chaser_sigma_m_s: float = 0.0,
        inertia_kg_m2: Floats | None = None,
        errors: LastingErrors = WHITE,
    ) -> None:
        if errors.count and (options.translation, options.rotation) != ("kalman", "mekf"):
            raise ValueError(
                "expected translation = kalman and rotation = mekf where errors last, got "
                f"{options.translation} and {options.rotation}: take white ones"
            )
        self._options = options
        self._errors = errors
        self._mount = CameraMount(cam_from_lvlh)
        self._chaser_sigmas = (chaser_sigma_m, chaser_sigma_m_s)
        self._process = RotationProcess(options, inertia_kg_m2, errors)
        self._translation: Floats | None = None

    @property
    def started(self) -> bool:
        """Whether there is a state."""
        return self._translation is not None

    def start(
        self,
        state: RelativeState,
        chaser: ChaserState,
        *,
        translation_covariance: Floats | None = None,
        rotation_covariance: Floats | None = None,
    ) -> FilteredState:
        """Begin, or begin again, from a state; covariances default to the options' start sigmas.

        Parameters
        ----------
        state : RelativeState
        chaser : ChaserState
            At the same time.
        translation_covariance : (6, 6) array, m and m/s, optional
            Of (rho, rho_dot), local frame.
        rotation_covariance : (6, 6) array, rad and rad/s, optional
            Of (turn, rate relative to the local frame), target axes.
        """
        option = self._options
        if translation_covariance is None:
            translation_covariance = _diagonal(option.start_sigma_m, option.start_sigma_m_s)
        if rotation_covariance is None:
            rotation_covariance = _diagonal(
                np.deg2rad(option.start_sigma_deg), np.deg2rad(option.start_sigma_deg_s)
            )
        unknown = np.zeros((3, self._errors.count))
        return self._begun(
            state,
            chaser,
            self._errors.begun(translation_covariance, unknown),
            self._errors.begun(rotation_covariance, unknown),
        )

    def _begun(
        self,
        state: RelativeState,
        chaser: ChaserState,
        translation_covariance: Floats,
        rotation_covariance: Floats,
    ) -> FilteredState:
        """Begin from a state, and covariances of it and of what lasts."""
        self._time_s = state.time_s
        self._orbit = KeplerOrbit.from_state(chaser)
        lasting = np.zeros(self._errors.count)
        self._translation = np.concatenate([state.rho_in_lvlh, state.rho_dot_in_lvlh, lasting])
        self._translation_covariance = translation_covariance
        self._rotation = self._process.state_from_relative(
            state.R_lvlh_from_target,
            state.omega_target_wrt_lvlh_in_target,
            rotation_covariance,
            self._orbit,
            self._time_s,
        )
        self._last_pose_s = state.time_s
        self._refused_in_row = 0
        return self._filtered()

    def start_from_pose(
        self, found: Estimate, chaser: ChaserState, mount: CameraMount | None = None
    ) -> FilteredState:
        """Begin, or begin again, from a pose alone; the rates are unknown and taken as none.

        Parameters
        ----------
        found : Estimate
        chaser : ChaserState
        mount : CameraMount, optional
            As it is known at this instant, where that is better known than before flight.

        Raises
        ------
        ValueError
            If the pose has no covariance to speak of: see ``covariance_fault``.
        """
        fault = _fault(found)
        if fault:
            raise ValueError(f"expected a pose to start from, got one with {fault}")
        pose = measured(found, mount or self._mount, self._errors)
        option = self._options
        translation = _diagonal(0.0, option.start_sigma_m_s)
        translation[:3, :3] = pose.position_noise
        rotation = _diagonal(0.0, np.deg2rad(option.start_sigma_deg_s))
        rotation[:3, :3] = pose.turn_noise
        still = RelativeState(
            found.time_s, pose.position, np.zeros(3), pose.R_lvlh_from_target, np.zeros(3)
        )
        begun = self._begun(
            still,
            chaser,
            self._errors.begun(translation, pose.position_effect),
            self._errors.begun(rotation, pose.turn_effect),
        )
        return replace(begun, used_pose=True)

    def predict(self, time_s: float, chaser: ChaserState) -> FilteredState:
        """Carry the state on to the time of the next frame.

        Parameters
        ----------
        time_s : float, s
        chaser : ChaserState
            As the absolute navigation has it, of about that time.

        Raises
        ------
        ValueError
            If time runs backwards, or nothing was started.
        """
        now = self._now()
        if not time_s >= self._time_s - SAME_TIME_S:
            raise ValueError(
                f"expected a time from {self._time_s} s on, got {time_s}: frames go forward in time"
            )
        self._orbit = KeplerOrbit.from_state(chaser)
        sigma_m, sigma_m_s = self._chaser_sigmas
        transition, noise = transition_and_noise(
            self._orbit,
            now[:6],
            self._time_s,
            time_s,
            sigma_m=sigma_m,
            sigma_m_s=sigma_m_s,
            acceleration_m_s2=self._options.acceleration_m_s2,
        )
        before = self._rotation.R_lvlh_from_target
        self._rotation = self._process.predict(self._rotation, self._orbit, self._time_s, time_s)
        turned = turn_between(before, self._rotation.R_lvlh_from_target)
        self._translation, self._translation_covariance = kalman.predict(
            now,
            self._translation_covariance,
            *self._errors.carried(transition, noise, float(np.linalg.norm(turned))),
        )
        if self._options.rotation == "minimum_energy" and self._options.forgetting_per_s:
            growth = float(np.exp(self._options.forgetting_per_s * (time_s - self._time_s)))
            self._rotation = replace(self._rotation, covariance=growth * self._rotation.covariance)
        self._time_s = time_s
        return self._filtered()

    def update(self, found: Estimate, mount: CameraMount | None = None) -> FilteredState:
        """Take in a pose of the time predicted to, if it agrees with the prediction.

        A pose refused, or one whose covariance is none, leaves the state as it was; ``reason``
        says why.

        Parameters
        ----------
        found : Estimate
        mount : CameraMount, optional
            As for ``start_from_pose``.

        Raises
        ------
        ValueError
            If the pose is of another time, or nothing was started.
        """
        now = self._now()
        if not abs(found.time_s - self._time_s) <= SAME_TIME_S:
            raise ValueError(
                f"expected a pose of {self._time_s} s, to which the filters were predicted, got "
                f"one of {found.time_s} s: predict first"
            )
        fault = _fault(found)
        if fault:
            return self._refused(f"the pose has {fault}")
        pose = measured(found, mount or self._mount, self._errors)
        moved, remark = self._translation_update(now, pose)
        turned = self._rotation_update(pose)
        gate = self._options.gate
        if isinstance(turned, NoMinimumEnergy):
            return self._refused(turned.reason, moved.nis)
        if not (positive(moved.covariance) and positive(turned.state.covariance)):
            remark = "the covariance after it would not be positive"
        elif gate and not max(moved.nis, turned.nis) <= gate:
            remark = (
                f"innovation squared {moved.nis:.1f} in position and {turned.nis:.1f} in attitude, "
                f"above {gate:.1f}"
            )
        else:
            self._translation, self._translation_covariance = moved.state, moved.covariance
            self._rotation = turned.state
            self._last_pose_s, self._refused_in_row = self._time_s, 0
            return self._filtered(True, remark, moved.nis, turned.nis)
        return self._refused(remark, moved.nis, turned.nis)

    def _refused(
        self,
        reason: str,
        translation_nis: float | None = None,
        rotation_nis: float | None = None,
    ) -> FilteredState:
        self._refused_in_row += 1
        return self._filtered(False, reason, translation_nis, rotation_nis)

    def _translation_update(
        self, now: Floats, pose: PoseMeasurement
    ) -> tuple[kalman.LinearUpdate, str]:
        seen = np.hstack([_POSITION_IS_SEEN, pose.position_effect])
        place, noise = pose.position, pose.white_position
        if self._options.translation == "kalman":
            return kalman.update(now, self._translation_covariance, place, seen, noise), ""
        found = h_infinity.update(
            now,
            self._translation_covariance,
            place,
            seen,
            noise,
            theta=h_infinity.theta_of_share(self._options.theta_share, noise),
            weights=np.eye(6),
        )
        if isinstance(found, kalman.LinearUpdate):
            return found, ""
        plain = kalman.update(now, self._translation_covariance, place, seen, noise)
        return plain, f"Kalman for once: {found.reason}"

    def _rotation_update(self, pose: PoseMeasurement) -> RotationUpdate | NoMinimumEnergy:
        attitude, noise = pose.R_lvlh_from_target, pose.white_turn
        if self._options.rotation == "mekf":
            return multiplicative_ekf.update(self._rotation, attitude, noise, pose.turn_effect)
        return minimum_energy.update(self._rotation, attitude, noise)

    def _now(self) -> Floats:
        if self._translation is None:
            raise ValueError("expected a state to go on from: call start or start_from_pose first")
        return self._translation

    def _filtered(
        self,
        used_pose: bool = False,
        reason: str = "",
        translation_nis: float | None = None,
        rotation_nis: float | None = None,
    ) -> FilteredState:
        now = self._now()
        omega, rotation_covariance = self._process.relative_from_state(
            self._rotation, self._orbit, self._time_s
        )
        return FilteredState(
            RelativeState(
                self._time_s, now[:3], now[3:6], self._rotation.R_lvlh_from_target, omega
            ),
            self._translation_covariance[:6, :6],
            rotation_covariance,
            used_pose,
            reason,
            translation_nis,
            rotation_nis,
            self._refused_in_row,
            self._time_s - self._last_pose_s,
        )


def _fault(found: Estimate) -> str:
    """Say what is wrong with the covariance of an estimate's pose; empty where nothing is."""
    return covariance_fault(None if found.pose is None else found.pose.covariance)


def _diagonal(first: float, second: float) -> Floats:
    return np.diag(np.array([*3 * [first], *3 * [second]], dtype=np.float64) ** 2)
