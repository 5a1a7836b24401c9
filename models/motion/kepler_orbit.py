"""An unperturbed elliptic orbit about Earth: elements, states, and the axes that go round with it.

The local frame (LVLH) of a satellite is x radial and away from Earth, z along the orbital
momentum, y = z cross x: along track.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from models.arrays import Floats
from models.motion.clohessy_wiltshire import EARTH_MU_M3_S2, mean_motion
from models.motion.relative_state import ChaserState

KEPLER_TOLERANCE_RAD = 4e-16  # of the eccentric anomaly: the rounding of 1
KEPLER_ITERATIONS = 50  # Newton needs 3 to 6; a last bit that flickers must not loop for ever
ROUND = 1e-12  # eccentricity, or sine of inclination, below which an axis is taken by convention


def eccentric_anomaly(mean_anomaly_rad: float, eccentricity: float) -> float:
    """Return E of Kepler's equation ``M = E - e sin E``, rad, within half a turn of zero.

    References
    ----------
    Newton's iteration from Danby's start (Fundamentals of Celestial Mechanics, 1992, section 6.6),
    from which it always converges.
    """
    mean = math.atan2(math.sin(mean_anomaly_rad), math.cos(mean_anomaly_rad))
    found = mean + math.copysign(0.85 * eccentricity, mean)
    for _ in range(KEPLER_ITERATIONS):
        excess = found - eccentricity * math.sin(found) - mean
        step = excess / (1.0 - eccentricity * math.cos(found))
        found -= step
        if abs(step) <= KEPLER_TOLERANCE_RAD * max(1.0, abs(found)):
            break
    return found


@dataclass(frozen=True)
class KeplerOrbit:
    """An ellipse, and where on it the satellite is at time zero.

    Attributes
    ----------
    semi_major_axis_m : float, m
    eccentricity : float
        In [0, 1).
    inclination_rad, raan_rad, argument_of_perigee_rad : float, rad
        The usual 3-1-3 turns from the inertial frame to the perifocal one.
    true_anomaly_rad : float, rad
        At ``epoch_s``.
    epoch_s : float, s

    Raises
    ------
    ValueError
        If a value is not finite, the axis is not positive or the orbit is no ellipse.
    """

    semi_major_axis_m: float
    eccentricity: float
    inclination_rad: float
    raan_rad: float
    argument_of_perigee_rad: float
    true_anomaly_rad: float
    epoch_s: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            if not np.isfinite(getattr(self, field.name)):
                raise ValueError(f"expected a finite {field.name}, got {getattr(self, field.name)}")
        if not 0.0 <= self.eccentricity < 1.0:
            raise ValueError(
                f"expected an elliptic orbit, eccentricity in [0, 1), got {self.eccentricity}"
            )
        mean_motion(self.semi_major_axis_m)  # refuses an axis that is none

    @classmethod
    def from_elements_deg(
        cls,
        *,
        a_km: float,
        e: float,
        i_deg: float,
        raan_deg: float,
        argument_of_perigee_deg: float,
        true_anomaly_deg: float,
    ) -> KeplerOrbit:
        """Read the elements as the papers' tables print them.

        Parameters
        ----------
        a_km : float, km
            Semi-major axis.
        e : float
            Eccentricity, in [0, 1).
        i_deg, raan_deg, argument_of_perigee_deg : float, deg
            Inclination, right ascension of the ascending node, argument of perigee.
        true_anomaly_deg : float, deg
            At time zero.
        """
        return cls(
            1e3 * a_km,
            e,
            *(
                float(np.deg2rad(angle))
                for angle in (i_deg, raan_deg, argument_of_perigee_deg, true_anomaly_deg)
            ),
        )

    @classmethod
    def from_state(cls, state: ChaserState) -> KeplerOrbit:
        """Return the orbit on which a satellite is; its epoch is the state's time.

        A circle's perigee is taken at its node, and an equatorial orbit's node on the inertial x
        axis: the elements then jump with the state, the motion that they describe does not.

        Raises
        ------
        ValueError
            If the state is no ellipse.

        References
        ----------
        Vallado, Fundamentals of Astrodynamics and Applications, algorithm 9.
        """
        position = np.asarray(state.position_in_inertial, dtype=np.float64)
        velocity = np.asarray(state.velocity_in_inertial, dtype=np.float64)
        radius = math.sqrt(float(position @ position))
        momentum = _cross(position, velocity)
        size = math.sqrt(float(momentum @ momentum))
        energy = 0.5 * float(velocity @ velocity) - EARTH_MU_M3_S2 / max(radius, 1.0)
        if not (energy < 0.0 and size > 0.0):
            raise ValueError(
                f"expected a state on an ellipse about Earth, got position {position} m and "
                f"velocity {velocity} m/s"
            )
        normal = momentum / size
        to_perigee = _cross(velocity, momentum) / EARTH_MU_M3_S2 - position / radius
        eccentricity = math.sqrt(float(to_perigee @ to_perigee))
        tilt = math.hypot(normal[0], normal[1])
        node = np.array([-normal[1], normal[0], 0.0]) if tilt > ROUND else np.array([1.0, 0.0, 0.0])
        node /= math.hypot(node[0], node[1])
        perigee = to_perigee if eccentricity > ROUND else node
        return cls(
            -0.5 * EARTH_MU_M3_S2 / energy,
            eccentricity if eccentricity > ROUND else 0.0,
            math.atan2(tilt, normal[2]),
            math.atan2(node[1], node[0]),
            _angle_about(normal, node, perigee),
            _angle_about(normal, perigee, position),
            state.time_s,
        )

    @property
    def mean_motion_rad_s(self) -> float:
        """Mean motion, rad/s."""
        return mean_motion(self.semi_major_axis_m)

    @property
    def semi_latus_rectum_m(self) -> float:
        """Semi-latus rectum p, m."""
        return self.semi_major_axis_m * (1.0 - self.eccentricity**2)

    @property
    def momentum_m2_s(self) -> float:
        """Orbital momentum h over mass, m2/s."""
        return math.sqrt(EARTH_MU_M3_S2 * self.semi_latus_rectum_m)

    def true_anomaly(self, time_s: float) -> float:
        """Return the true anomaly, rad, within half a turn of zero."""
        e = self.eccentricity
        mean = self._mean_anomaly_rad + self.mean_motion_rad_s * (time_s - self.epoch_s)
        now = eccentric_anomaly(mean, e)
        return math.atan2(math.sqrt(1.0 - e * e) * math.sin(now), math.cos(now) - e)

    def radius_m(self, time_s: float) -> float:
        """Return the distance from Earth's centre, m."""
        return self._radius_m(self.true_anomaly(time_s))

    def anomaly_rate(self, time_s: float) -> float:
        """Return the rate of the true anomaly, rad/s: that of the local frame about its z."""
        return self.momentum_m2_s / self.radius_m(time_s) ** 2

    def anomaly_acceleration(self, time_s: float) -> float:
        """Return the second derivative of the true anomaly, rad/s2."""
        anomaly = self.true_anomaly(time_s)
        pull = EARTH_MU_M3_S2 / self._radius_m(anomaly) ** 3
        return -2.0 * pull * self.eccentricity * math.sin(anomaly)

    def inertial_from_lvlh(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation whose columns are radial, along-track and normal."""
        return self._axes_at(self.true_anomaly(time_s))

    def state(self, time_s: float) -> ChaserState:
        """Return the inertial position and velocity at a time."""
        anomaly = self.true_anomaly(time_s)
        axes = self._axes_at(anomaly)
        speed = EARTH_MU_M3_S2 / self.momentum_m2_s
        e = self.eccentricity
        velocity = speed * np.array([e * math.sin(anomaly), 1.0 + e * math.cos(anomaly), 0.0])
        return ChaserState(time_s, axes[:, 0] * self._radius_m(anomaly), axes @ velocity)

    @cached_property
    def _mean_anomaly_rad(self) -> float:
        e = self.eccentricity
        s, c = math.sin(self.true_anomaly_rad), math.cos(self.true_anomaly_rad)
        eccentric = math.atan2(math.sqrt(1.0 - e * e) * s, e + c)
        return eccentric - e * math.sin(eccentric)

    def _radius_m(self, anomaly: float) -> float:
        return self.semi_latus_rectum_m / (1.0 + self.eccentricity * math.cos(anomaly))

    def _axes_at(self, anomaly: float) -> Floats:
        around = _turn_about_z(self.argument_of_perigee_rad + anomaly)
        return _turn_about_z(self.raan_rad) @ _turn_about_x(self.inclination_rad) @ around


def _angle_about(axis: Floats, start: Floats, end: Floats) -> float:
    return math.atan2(float(axis @ _cross(start, end)), float(start @ end))


def _cross(first: Floats, second: Floats) -> Floats:
    """Return the cross product of two vectors, ten times as fast as numpy's."""
    a, b, c = first.tolist()
    x, y, z = second.tolist()
    return np.array([b * z - c * y, c * x - a * z, a * y - b * x])


def _turn_about_z(angle: float) -> Floats:
    s, c = math.sin(angle), math.cos(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _turn_about_x(angle: float) -> Floats:
    s, c = math.sin(angle), math.cos(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
