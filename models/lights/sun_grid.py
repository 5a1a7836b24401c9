"""Sun directions spread over the whole sphere, nearly even: rings of constant elevation.

Azimuth and elevation are those of ``models.lights.sun``: azimuth clockwise from +y seen from +z,
elevation from the face plane towards +z, both in the target frame. Elevation 90 deg lights the face
from straight behind the chaser; at -90 deg the Sun stands behind the target.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.errors import ScenarioError
from models.lights.sun import SUN_CASES_DEG, direction_from_azimuth, sun_direction

COARSEST_STEP_DEG, FINEST_STEP_DEG = 90.0, 1.0
DIGITS = 6  # of a vector written out: a turn of 1e-6 rad, far below the Sun's own radius
TYPED_STEP = 1e-5  # a step typed with six digits passes
POLE_SINE = 1e-9  # nearer to a pole than this, azimuth means nothing and is told as 0


@dataclass(frozen=True)
class NamedSun:
    """A Sun of a sweep, and how to type it.

    Attributes
    ----------
    name : str
        ``S2``, or azimuth and elevation in deg such as ``270/45``.
    text : str
        What the option ``--sun`` reads as the same direction to the bit.
    azimuth_deg, elevation_deg : float, deg
        Azimuth in [0, 360); 0 at the poles.
    """

    name: str
    text: str
    azimuth_deg: float
    elevation_deg: float

    @property
    def direction_in_target(self) -> Floats:
        """Unit vector towards it, (3,)."""
        return sun_direction(self.text)


def azimuth_elevation_deg(direction_in_target: Floats) -> tuple[float, float]:
    """Return azimuth, in [0, 360), and elevation of a unit vector, deg.

    Parameters
    ----------
    direction_in_target : (3,) array
        Of length one.
    """
    x, y, z = (float(component) for component in direction_in_target)
    level = float(np.hypot(x, y))
    elevation_deg = float(np.rad2deg(np.arctan2(z, level)))
    if level < POLE_SINE:
        return 0.0, elevation_deg
    return float(np.rad2deg(np.arctan2(x, y)) % 360.0) % 360.0, elevation_deg


def sun_at(azimuth_deg: float, elevation_deg: float) -> NamedSun:
    """Return the Sun at an azimuth and elevation, deg.

    Raises
    ------
    ScenarioError
        If an angle is not finite or the elevation is beyond a pole.
    """
    if not np.isfinite(azimuth_deg) or not abs(elevation_deg) <= 90.0:
        raise ScenarioError(
            "expected a Sun's azimuth/elevation in deg, such as 270/45, with an elevation from "
            f"-90 to 90, got {azimuth_deg:g}/{elevation_deg:g}"
        )
    wrapped_deg = 0.0 if abs(elevation_deg) == 90.0 else azimuth_deg % 360.0
    # Rounded first and given a length again by whoever reads it, as if the text had been typed.
    direction = direction_from_azimuth(wrapped_deg, elevation_deg)
    text = ",".join(f"{component + 0.0:.{DIGITS}f}" for component in direction.round(DIGITS) + 0.0)
    return NamedSun(f"{wrapped_deg:.4g}/{elevation_deg:.4g}", text, wrapped_deg, elevation_deg)


def read_sun(text: str) -> NamedSun:
    """Read ``S1`` to ``S7``, ``azimuth/elevation`` in deg, or a vector ``x,y,z``.

    Raises
    ------
    ScenarioError
        If it is none of them; the message says what is.
    """
    typed = text.strip()
    if typed.upper() in SUN_CASES_DEG:
        return NamedSun(typed.upper(), typed.upper(), *SUN_CASES_DEG[typed.upper()])
    if "/" in typed:
        try:
            azimuth_deg, elevation_deg = (float(part) for part in typed.split("/"))
        except ValueError as error:
            raise ScenarioError(
                f"expected a Sun's azimuth/elevation in deg, such as 270/45, got {text!r}"
            ) from error
        return sun_at(azimuth_deg, elevation_deg)
    if "," not in typed:
        raise ScenarioError(
            f"expected a Sun among {', '.join(SUN_CASES_DEG)}, its azimuth/elevation in deg, such "
            f"as 270/45, or a vector x,y,z in the target frame, got {text!r}"
        )
    azimuth_deg, elevation_deg = azimuth_elevation_deg(sun_direction(typed))
    return NamedSun(f"{azimuth_deg:.4g}/{elevation_deg:.4g}", typed, azimuth_deg, elevation_deg)


def sun_grid(step_deg: float) -> list[NamedSun]:
    """Return Suns over the whole sphere, no two neighbours of a ring farther apart than the step.

    Rings stand at equal steps of elevation, the poles among them; along a ring the azimuth's step
    is widened by ``1 / cos(elevation)``, so that each Sun stands for about ``step**2`` of solid
    angle. 15 deg gives 188.

    Parameters
    ----------
    step_deg : float, deg
        Divides 180; from 1 to 90.

    Raises
    ------
    ScenarioError
        If it does not; the message names the nearest that does.
    """
    rings = max(round(180.0 / step_deg), 2) if np.isfinite(step_deg) and step_deg > 0.0 else 12
    nearest_deg = min(max(180.0 / rings, FINEST_STEP_DEG), COARSEST_STEP_DEG)
    if not abs(step_deg - nearest_deg) < TYPED_STEP * nearest_deg:
        raise ScenarioError(
            f"expected a step of the Suns, in deg, that divides 180 and is from "
            f"{FINEST_STEP_DEG:g} to {COARSEST_STEP_DEG:g}, such as 10, 15, 22.5, 30 or 45, "
            f"got {step_deg:g}; {nearest_deg:.6g} is the nearest"
        )
    suns = []
    for ring in range(rings + 1):
        elevation_deg = 90.0 - 180.0 * ring / rings
        around = 2.0 * rings * np.cos(np.deg2rad(elevation_deg))
        count = max(1, int(np.ceil(around - 1e-6)))
        suns += [sun_at(360.0 * number / count, elevation_deg) for number in range(count)]
    return suns


def chosen_suns(texts: tuple[str, ...]) -> list[NamedSun]:
    """Read a list of Suns, each once, in the order typed.

    Parameters
    ----------
    texts : tuple of str
        Each a Sun (see ``read_sun``), several names with commas between, or ``paper`` for S1 to S7.

    Raises
    ------
    ScenarioError
        If one is no Sun, or there are none.
    """
    suns: list[NamedSun] = []
    for text in texts:
        for part in _parts(text):
            suns.append(read_sun(part))
    if not suns:
        raise ScenarioError(
            f"expected at least one Sun, got none; give `paper` ({', '.join(SUN_CASES_DEG)}), "
            "names, azimuth/elevation in deg such as 270/45, or vectors x,y,z in the target frame"
        )
    first: dict[tuple[float, ...], NamedSun] = {}
    for sun in suns:
        first.setdefault(tuple((sun.direction_in_target.round(DIGITS) + 0.0).tolist()), sun)
    return list(first.values())


def _parts(text: str) -> list[str]:
    """Split ``S1,S3,90/10``, but not a vector."""
    if text.strip().lower() == "paper":
        return list(SUN_CASES_DEG)
    parts = [part for part in text.split(",") if part.strip()]
    if any("/" in part or part.strip().upper() in SUN_CASES_DEG for part in parts):
        return parts
    return [text]
