"""What lamps and lens have become since they were calibrated: drawn in every run, told to nobody.

Lamps give another power and another pattern (a slope over the field), the lens darkens otherwise
towards its corners and spreads points otherwise, and more so there. A blur that varies over the
field is the blend of two: kernels that add up to one have variances that blend as they do.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from models.arrays import AnyArray, Floats, Radiance
from models.camera import Camera
from models.sensors.bayer_mosaic import BANDS
from renders.detector.point_spread import blur
from renders.scenario.drift_table import DriftTable
from renders.tracing.light_groups import LampGroup, LightGroup
from renders.world.told_draws import drawn

Part: TypeAlias = tuple[slice, slice]
"""Rows and columns of an image."""

COLOURS = tuple(f"_{band.name}" for band in BANDS)
LEAST = 0.2  # of what was: no draw turns a lamp off or a point spread inside out


@dataclass(frozen=True)
class Drift:
    """One run's lamps and lens.

    Attributes
    ----------
    run : int
    table : DriftTable
    """

    run: int
    table: DriftTable

    @classmethod
    def of(cls, table: DriftTable | None, run: int) -> Drift | None:
        """Return a run's; None where nothing drifts."""
        return None if table is None else cls(run, table)

    def lit(
        self, groups: Mapping[LightGroup, Radiance], camera: Camera
    ) -> dict[LightGroup, Radiance]:
        """Return light groups as the lamps now give them.

        Parameters
        ----------
        groups : mapping of LightGroup to (height, width) arrays, W m-2 sr-1
        camera : Camera

        Returns
        -------
        dict of LightGroup to (height, width) arrays, W m-2 sr-1
        """
        whole = (slice(0, camera.height), slice(0, camera.width))
        return {
            group: (radiance * self.of_lamp(group.name, camera, whole)).astype(np.float32)
            if isinstance(group, LampGroup)
            else radiance
            for group, radiance in groups.items()
        }

    def of_lamp(self, name: str, camera: Camera, part: Part) -> Floats:
        """Return what is left of a lamp's light at each pixel of a part, over what was.

        Parameters
        ----------
        name : str
            Of the lamp's light group; all colours of a lamp drift alike.
        camera : Camera
        part : (slice, slice)

        Returns
        -------
        (rows, columns) array
        """
        x, y = _field(camera, part)
        power = drawn(self.run, f"drift.lamp_power.{lamp_of(name)}", 1)[0]
        slope = self.table.lamp_tilt * drawn(self.run, "drift.lamp_tilt", 2)
        factor = 1.0 + self.table.lamp_power * power + slope[0] * x + slope[1] * y
        return np.maximum(factor, LEAST)

    def darkened(self, camera: Camera, part: Part) -> Floats:
        """Return the light that comes through at each pixel of a part, over what did.

        Parameters
        ----------
        camera : Camera
        part : (slice, slice)

        Returns
        -------
        (rows, columns) array
        """
        x, y = _field(camera, part)
        share = self.table.vignetting * drawn(self.run, "drift.vignetting", 1)[0]
        return np.maximum(1.0 + 0.5 * share * (x**2 + y**2), LEAST)

    def blurred(self, image: AnyArray, sigma_px: float, camera: Camera, part: Part) -> Floats:
        """Spread a part of an image as the lens now does.

        Parameters
        ----------
        image : (height, width) array
            Of the part.
        sigma_px : float, px
            Of the point spread as it was.
        camera : Camera
        part : (slice, slice)

        Returns
        -------
        (rows, columns) array
        """
        wider, over_field = drawn(self.run, "drift.blur", 2)
        middle_px = sigma_px * max(1.0 + self.table.blur * wider, LEAST)
        corner_px = middle_px * max(1.0 + self.table.blur_over_field * over_field, LEAST)
        if corner_px == middle_px:
            return blur(image, middle_px)
        x, y = _field(camera, part)
        share = np.minimum(0.5 * (x**2 + y**2), 1.0)
        return (1.0 - share) * blur(image, middle_px) + share * blur(image, corner_px)


def drift_sigmas(table: DriftTable | None, sigma_px: float) -> dict[str, float]:
    """Return what a pipeline is told of drifts: their sigmas, by ``file.key``.

    Parameters
    ----------
    table : DriftTable or None
    sigma_px : float, px
        Of the point spread as it was.
    """
    if table is None:
        return {}
    told = {
        "lamps.power": table.lamp_power,
        "lamps.tilt": table.lamp_tilt,
        "optics.vignetting": table.vignetting,
        "optics.psf_sigma_px": sigma_px * float(np.hypot(table.blur, table.blur_over_field)),
    }
    return {key: sigma for key, sigma in told.items() if sigma > 0.0}


def lamp_of(group: str) -> str:
    """Return the name of a lamp, whatever colour of it a light group is of.

    Parameters
    ----------
    group : str
        Name of the light group.
    """
    return next((group.removesuffix(end) for end in COLOURS if group.endswith(end)), group)


def _field(camera: Camera, part: Part) -> tuple[Floats, Floats]:
    """Return where pixels of a part lie in the image: 0 in the middle, 1 at its edges."""
    rows, columns = part
    u = np.arange(columns.start, columns.stop) - 0.5 * (camera.width - 1)
    v = np.arange(rows.start, rows.stop) - 0.5 * (camera.height - 1)
    return (2.0 * u / camera.width)[None, :], (2.0 * v / camera.height)[:, None]
