"""What stands far off, in target axes: the Suns, the Earth and the stars, at any instant.

Each is given in axes of a reference frame: the target's own (a stabilised target hardly turns while
it is approached), or the inertial frame of an orbit, whose axes are those of the ICRS.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, Protocol

import numpy as np

from models.arrays import Floats
from models.lights.earth import Earth
from models.lights.eclipse import share_past_earth
from models.lights.sun import NAMED_SUNS, sun_direction, unit_direction
from models.motion.attitude_wobble import AttitudeWobble
from models.motion.table_motion import Stills
from models.sky.earth_pointing import earth_pointing, rotation_from_wxyz, turned
from renders.scenario.light_tables import EarthTable
from renders.scenario.sky_tables import StarsTable
from renders.tracing.light_groups import EarthGroup, SunGroup
from renders.world.trajectory import FreeMotion


class Turning(Protocol):
    """How the sky turns over the target."""

    @property
    def suns_stand_still(self) -> bool:
        """Whether each Sun stays where it is in target axes."""
        ...

    def sun_in_target(self, direction: tuple[float, float, float], time_s: float) -> list[float]:
        """Return a Sun's direction in target axes, from the axes in which it was typed."""
        ...

    def earth_at(self, time_s: float) -> tuple[Floats, float]:
        """Return the unit vector towards the Earth's centre, target frame, and its distance, km."""
        ...

    def target_from_icrs(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation of the target among the stars."""
        ...


@dataclass(frozen=True, eq=False)
class FixedInTarget:
    """Sun and Earth stand still in target axes; the stars turn as the target's attitude says.

    Attributes
    ----------
    earth : EarthTable
    stars : StarsTable
    sway : AttitudeWobble or None
        Of the target about its nominal attitude.
    """

    earth: EarthTable
    stars: StarsTable
    sway: AttitudeWobble | None = None
    suns_stand_still: ClassVar[bool] = True

    def sun_in_target(self, direction: tuple[float, float, float], time_s: float) -> list[float]:
        """Return it as typed."""
        return list(direction)

    def earth_at(self, time_s: float) -> tuple[Floats, float]:
        """Return the Earth as typed: (3,) unit vector to its centre, target frame; distance, km."""
        return unit_direction(self.earth.direction), self.earth.orbit_radius_km

    def target_from_icrs(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation of the target among the stars, sway and all."""
        wxyz = self.stars.q_target_from_icrs_wxyz
        zenith_deg = self.stars.zenith_right_ascension_deg
        start = rotation_from_wxyz(wxyz) if wxyz else earth_pointing(zenith_deg)
        nominal = turned(start, self.stars.rate_in_target_deg_h, time_s)
        if self.sway is None:
            return nominal
        return self.sway.nominal_from_target(time_s).T @ nominal


@dataclass(frozen=True, eq=False)
class TurningWithOrbit:
    """The Sun stands still in the orbit's inertial frame, the Earth lies below the chaser.

    Attributes
    ----------
    motion : FreeMotion
    """

    motion: FreeMotion
    suns_stand_still: ClassVar[bool] = False

    def sun_in_target(self, direction: tuple[float, float, float], time_s: float) -> list[float]:
        """Return it from inertial axes."""
        turned_into: list[float] = (
            self.motion.target_from_inertial(time_s) @ np.array(direction)
        ).tolist()
        return turned_into

    def earth_at(self, time_s: float) -> tuple[Floats, float]:
        """Return where the Earth lies below: (3,) unit vector, target frame; distance, km."""
        position = self.motion.chaser_state(time_s).position_in_inertial
        distance = float(np.linalg.norm(position))
        down = self.motion.target_from_inertial(time_s) @ (-position / distance)
        return down, 1e-3 * distance

    def target_from_icrs(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation of the target among the stars."""
        return self.motion.target_from_inertial(time_s)


@dataclass(frozen=True, eq=False)
class Sky:
    """Suns and Earth as light groups.

    Attributes
    ----------
    turning : Turning
    sun : SunGroup
        That shines on the frames, as typed.
    shared : tuple of SunGroup
        Rendered in one pass with any other.
    earth : EarthTable
        Whether it shines, and how much of the Sun it returns.
    rows : Stills or None
        A table of poses whose rows may say what stands behind the target.
    eclipses : bool
        Whether the Earth hides a Sun that stands behind it: where both follow from an orbit.
    """

    turning: Turning
    sun: SunGroup
    shared: tuple[SunGroup, ...]
    earth: EarthTable
    rows: Stills | None = None
    eclipses: bool = False

    def earth_at(self, time_s: float) -> tuple[Floats, float]:
        """Return the (3,) unit vector to the Earth's centre, target frame, and its distance, km."""
        towards, distance_km = self.turning.earth_at(time_s)
        own = self._own_earth(time_s)
        return towards if own is None else own, distance_km

    def shows_earth(self, time_s: float) -> bool:
        """Tell whether there is an Earth at an instant."""
        own = self._own_earth(time_s)
        return self.earth.shines and (own is None or bool(own.any()))

    def shows_stars(self, time_s: float) -> bool:
        """Tell whether stars, where they shine at all, are seen at an instant."""
        return self.rows is None or self.rows.shows_stars(time_s)

    def _own_earth(self, time_s: float) -> Floats | None:
        """Return that of the table's row, zeros for none; None where no table says."""
        return None if self.rows is None else self.rows.earth_dir_in_target(time_s)

    @property
    def suns(self) -> list[SunGroup]:
        """Every Sun that is rendered: the shared ones, and the one asked for if not among them."""
        if self.sun.name in {sun.name for sun in self.shared}:
            return list(self.shared)
        return [*self.shared, self.sun]

    def sun_at(self, sun: SunGroup, time_s: float) -> SunGroup:
        """Return a Sun as it stands at an instant, in target axes."""
        x, y, z = self.turning.sun_in_target(sun.direction_in_target, time_s)
        return replace(sun, direction_in_target=(x, y, z))

    def sunlit_share(self, sun: SunGroup, time_s: float) -> float:
        """Return how much of a Sun's disc the Earth leaves free at an instant, 0 to 1.

        Parameters
        ----------
        sun : SunGroup
            As it stands then, in target axes.
        time_s : float, s
        """
        if not self.eclipses:
            return 1.0
        down, distance_km = self.earth_at(time_s)
        radius_rad = float(np.deg2rad(0.5 * sun.angular_diameter_deg))
        return share_past_earth(np.array(sun.direction_in_target), down, distance_km, radius_rad)

    def lit_under(self, sun: SunGroup, time_s: float) -> list[SunGroup | EarthGroup]:
        """Return what a Sun gives light to at an instant: itself, and the Earth that it lights.

        In the umbra that is nothing: what is seen of the Earth from there is its night.

        Parameters
        ----------
        sun : SunGroup
            As it stands then, in target axes.
        time_s : float, s
        """
        if self.sunlit_share(sun, time_s) <= 0.0:
            return []
        return [sun, *self.earth_under(sun, time_s)]

    def earth_under(self, sun: SunGroup, time_s: float) -> list[EarthGroup]:
        """Return the Earth as a Sun lights it, if there is one."""
        if not self.shows_earth(time_s):
            return []
        direction, radius_km = self.earth_at(time_s)
        x, y, z = direction.tolist()
        earth = Earth(
            (x, y, z), sun.direction_in_target, radius_km, self.earth.albedo, sun.irradiance_w_m2
        )
        return [EarthGroup(sun.name.replace("sun", "earth", 1), earth)]


def sun_group(text: str) -> SunGroup:
    """Return the light group of a Sun of the papers' or typed as x,y,z."""
    direction = sun_direction(text)
    name = text.strip().upper()
    if name not in NAMED_SUNS:
        name = "_".join(f"{x:+.6f}" for x in direction)
    return SunGroup(f"sun_{name}", (float(direction[0]), float(direction[1]), float(direction[2])))
