"""Equations 17 to 23 of Volpe et al. 2017 for many states at once.

The print has lost its formulas; these follow from the text. A state is ``(rho_i, P_i, q, omega,
rho, rho', I)``: points from the chaser in camera axes, points from the target's centre of mass in
body axes, the attitude (camera from body, scalar last), the inertial rate in body axes, the
chaser with respect to the target in the paper's Hill frame (radial, normal, against the motion),
and the inertia's six entries (11, 22, 33, 12, 13, 23).

The camera looks at the target's centre of mass, so that its attitude and rate are functions of
``rho`` and ``rho'`` (section 3.2, ``models.motion.boresight_pointing``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats

_AT = np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])  # place of an inertia's entries in a state


@dataclass(frozen=True)
class PaperState:
    """Where everything is in a state of ``points`` points: 6 n + 19 numbers."""

    points: int

    @property
    def size(self) -> int:
        """Numbers of a state: 91 for twelve points."""
        return 6 * self.points + 19

    @property
    def from_chaser(self) -> slice:
        """rho_i."""
        return slice(0, 3 * self.points)

    @property
    def from_centre(self) -> slice:
        """P_i."""
        return slice(3 * self.points, 6 * self.points)

    def _rest(self, first: int, last: int) -> slice:
        return slice(6 * self.points + first, 6 * self.points + last)

    @property
    def quaternion(self) -> slice:
        """Camera from body, scalar last."""
        return self._rest(0, 4)

    @property
    def omega(self) -> slice:
        """Inertial rate, body axes."""
        return self._rest(4, 7)

    @property
    def rho(self) -> slice:
        """Chaser from target, Hill frame."""
        return self._rest(7, 10)

    @property
    def rho_dot(self) -> slice:
        """Its rate in the turning frame."""
        return self._rest(10, 13)

    @property
    def inertia(self) -> slice:
        """Six entries."""
        return self._rest(13, 19)


def rate(layout: PaperState, states: Floats, mean_motion_rad_s: float) -> Floats:
    """Return the derivatives of states by time (equations 18a to 18h).

    Parameters
    ----------
    layout : PaperState
    states : (s, 6 n + 19) array
    mean_motion_rad_s : float, rad/s

    Returns
    -------
    (s, 6 n + 19) array
    """
    n = mean_motion_rad_s
    rho, rho_dot = states[:, layout.rho], states[:, layout.rho_dot]
    cam_from_hill, spin, distance, closing = pointing(rho, rho_dot)
    cam_from_body = rotations(states[:, layout.quaternion])
    omega, inertia = states[:, layout.omega], states[:, layout.inertia][:, _AT]
    radial = np.einsum("sij,si->sj", cam_from_body, cam_from_hill[:, :, 0])
    torque = 3.0 * n**2 * cross(radial, times(inertia, radial))
    torque -= cross(omega, times(inertia, omega))
    of_camera = spin + n * cam_from_hill[:, :, 1]  # inertial, camera axes
    relative = times(cam_from_body, omega) - of_camera
    in_body = np.einsum("sij,si->sj", cam_from_body, relative)
    centre = np.zeros_like(rho)
    centre[:, 2], rates = distance, np.zeros_like(states)
    from_chaser = states[:, layout.from_chaser].reshape(len(states), -1, 3)
    moved = cross(relative[:, None], from_chaser - centre[:, None])
    moved[:, :, 2] += closing[:, None]
    rates[:, layout.from_chaser] = moved.reshape(len(states), -1)
    rates[:, layout.quaternion] = _turned(states[:, layout.quaternion], in_body)
    rates[:, layout.omega] = np.linalg.solve(inertia, torque[..., None])[..., 0]
    rates[:, layout.rho] = rho_dot
    rates[:, layout.rho_dot] = np.column_stack(
        [
            3.0 * n**2 * rho[:, 0] - 2.0 * n * rho_dot[:, 2],
            -(n**2) * rho[:, 1],
            2.0 * n * rho_dot[:, 0],
        ]
    )
    return rates


def step(layout: PaperState, states: Floats, mean_motion_rad_s: float, step_s: float) -> Floats:
    """Return (s, 6 n + 19) states a step later, by Runge and Kutta's fourth order.

    Parameters
    ----------
    layout : PaperState
    states : (s, 6 n + 19) array
    mean_motion_rad_s : float, rad/s
    step_s : float, s
    """

    def slope(now: Floats) -> Floats:
        return rate(layout, now, mean_motion_rad_s)

    k1 = slope(states)
    k2 = slope(states + 0.5 * step_s * k1)
    k3 = slope(states + 0.5 * step_s * k2)
    k4 = slope(states + step_s * k3)
    later = states + step_s / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    quaternion = later[:, layout.quaternion]
    later[:, layout.quaternion] = quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)
    return later


def observed(layout: PaperState, states: Floats, focal_px: tuple[float, float]) -> Floats:
    """Return what is measured (equation 23): the range, then u, v of each point, (s, 1 + 2 n).

    Parameters
    ----------
    layout : PaperState
    states : (s, 6 n + 19) array
    focal_px : (float, float), px
        Pixels count from the principal point.
    """
    points = states[:, layout.from_chaser].reshape(len(states), -1, 3)
    pixels = points[:, :, :2] / points[:, :, 2:] * focal_px
    distance = np.linalg.norm(states[:, layout.rho], axis=1)
    return np.column_stack([distance, pixels.reshape(len(states), -1)])


def redundancy(layout: PaperState, states: Floats) -> Floats:
    """Return by how much equation 15 is not held, (s, 3 n), m: zero for a state that may be.

    Parameters
    ----------
    layout : PaperState
    states : (s, 6 n + 19) array
    """
    points = states[:, layout.from_chaser].reshape(len(states), -1, 3).copy()
    points[:, :, 2] -= np.linalg.norm(states[:, layout.rho], axis=1)[:, None]
    own = states[:, layout.from_centre].reshape(len(states), -1, 3)
    turned = np.einsum("sij,snj->sni", rotations(states[:, layout.quaternion]), own)
    return (points - turned).reshape(len(states), -1)


def pointing(rho: Floats, rho_dot: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return how the camera stands and turns (equations 4 and 9).

    Parameters
    ----------
    rho, rho_dot : (s, 3) array, m and m/s
        Hill frame.

    Returns
    -------
    R_cam_from_hill : (s, 3, 3) array
    spin : (s, 3) array, rad/s
        Of the camera with respect to the Hill frame, camera axes.
    distance, closing : (s,) array, m and m/s
    """
    distance = np.linalg.norm(rho, axis=1)
    closing = np.sum(rho * rho_dot, axis=1) / distance
    forward = -rho / distance[:, None]
    turning = -rho_dot / distance[:, None] - forward * (closing / distance)[:, None]
    across = np.hypot(forward[:, 0], forward[:, 1])
    zero = np.zeros_like(distance)
    right = np.column_stack([-forward[:, 1] / across, forward[:, 0] / across, zero])
    azimuth_rate = (forward[:, 0] * turning[:, 1] - forward[:, 1] * turning[:, 0]) / across**2
    elevation_rate = -turning[:, 2] / across
    spin = np.column_stack([elevation_rate, azimuth_rate * across, azimuth_rate * forward[:, 2]])
    return np.stack([right, cross(forward, right), forward], axis=1), spin, distance, closing


def rotations(quaternions: Floats) -> Floats:
    """Return (s, 3, 3) matrices of (s, 4) quaternions, scalar last, of any length."""
    x, y, z, w = (quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)).T
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def times(matrices: Floats, vectors: Floats) -> Floats:
    """Return (s, 3) products.

    Parameters
    ----------
    matrices : (s, 3, 3) array
    vectors : (s, 3) array
    """
    return np.einsum("sij,sj->si", matrices, vectors)


def cross(first: Floats, second: Floats) -> Floats:
    """Return (..., 3): the cross product over the last axis of two (..., 3); NumPy's is slow."""
    ax, ay, az = first[..., 0], first[..., 1], first[..., 2]
    bx, by, bz = second[..., 0], second[..., 1], second[..., 2]
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=-1)


def _turned(quaternions: Floats, omega: Floats) -> Floats:
    """Return the derivatives of (s, 4) quaternions that turn at (s, 3) rates in body axes."""
    axis, scalar = quaternions[:, :3], quaternions[:, 3:]
    vector = scalar * omega + cross(axis, omega)
    return 0.5 * np.column_stack([vector, -np.sum(axis * omega, axis=1)])
