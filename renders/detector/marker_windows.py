"""Windows round the markers of an exposure, exposed again as often as a study has runs.

A run's own noise matters where markers are; elsewhere an image is that of the frame as it was
exposed once. So what the lens gets of a frame is kept round its markers alone, the lamps apart from
all else, and a run draws its noise there: a hundred runs cost a hundredth of as many frames.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from models.arrays import AnyArray, Floats, Image, Radiance
from models.camera import Camera
from models.errors import ScenarioError
from models.sensors.bayer_mosaic import mosaicked
from renders.detector.compose import rates_of
from renders.detector.drift import Drift, Part, lamp_of
from renders.detector.expose import expose_electrons, exposure_rng, mean_electrons
from renders.detector.point_spread import point_spread
from renders.scenario.scenario import Scenario
from renders.tracing.light_groups import LampGroup, LightGroup
from renders.world.exposure import Exposure
from renders.world.world import World

WINDOW_DRAW = 0x41ED  # keys a window's noise, apart from that of whole frames
WIDEST_BLUR = 2.0  # of the point spread as it was: what a window's rim must hold for a drift


@dataclass(frozen=True, eq=False)
class MarkerWindow:
    """What the lens gets round one marker.

    Attributes
    ----------
    top, left : int, px
        Its first row and column; even, as a colour mosaic's period is two.
    rim : int, px
        On each side inside of the image: seen by the blur alone, and not drawn again.
    lamps : dict of (planes, height, width) arrays, e/s
        By lamp: one plane, or red, green and blue.
    others : (planes, height, width) array, e/s
        Of all other light.
    """

    top: int
    left: int
    rim: int
    lamps: dict[str, AnyArray]
    others: AnyArray

    @property
    def part(self) -> Part:
        """Rows and columns of the image that it holds."""
        height, width = self.others.shape[1:]
        return slice(self.top, self.top + height), slice(self.left, self.left + width)


def check_windows(scenario: Scenario) -> None:
    """Refuse a scenario whose light near a marker depends on the whole image.

    Raises
    ------
    ScenarioError
    """
    for key, there in (
        ("optics.focus_m", scenario.optics.focus_m > 0.0),
        ("optics.veiling_glare", scenario.optics.veiling_glare > 0.0),
        ("stars.shine", scenario.stars.shine),
    ):
        if there:
            raise ScenarioError(
                f"{scenario.name}: expected {key} to be 0 or false where markers' windows are "
                "exposed apart from the image, got another; leave it out"
            )


def cut_windows(
    world: World,
    groups: Mapping[LightGroup, Radiance],
    exposure: Exposure,
    centres_px: Floats,
    reach_px: Floats,
) -> list[MarkerWindow | None]:
    """Cut the windows out of an exposure's light.

    Parameters
    ----------
    world : World
    groups : mapping of LightGroup to (height, width) arrays, W m-2 sr-1
        What lights it.
    exposure : Exposure
    centres_px : (n, 2) array, px
        Of the markers; NaN for one behind the camera.
    reach_px : (n,) array, px
        From a marker's centre as far as its noise is to be drawn.

    Returns
    -------
    list of MarkerWindow or None
        None for a marker that is not in the image.
    """
    lamps: dict[str, dict[LightGroup, Radiance]] = {}
    for group in groups:
        if isinstance(group, LampGroup):
            lamps.setdefault(lamp_of(group.name), {})[group] = groups[group]
    lit = {name: np.array(rates_of(world, own, exposure)) for name, own in lamps.items()}
    rest: dict[LightGroup, Radiance] = {
        group: light for group, light in groups.items() if not isinstance(group, LampGroup)
    }
    planes = next(iter(lit.values())) if lit else None
    others = np.array(rates_of(world, rest, exposure)) if rest else np.zeros_like(planes)
    sigma_px = world.scenario.simulated_optics.psf_sigma_px
    rim = len(point_spread(WIDEST_BLUR * sigma_px)) // 2
    return [
        _cut(world.camera, lit, others, centre, float(reach), rim + rim % 2)
        for centre, reach in zip(centres_px, reach_px, strict=True)
    ]


def _cut(
    camera: Camera,
    lit: Mapping[str, AnyArray],
    others: AnyArray,
    centre_px: Floats,
    reach_px: float,
    rim: int,
) -> MarkerWindow | None:
    if not (np.isfinite(centre_px).all() and camera.contains(centre_px, -reach_px)):
        return None
    low = np.floor(centre_px - reach_px).astype(int)
    low -= low % 2 + rim
    high = np.ceil(centre_px + reach_px).astype(int) + 1
    high += high % 2 + rim
    left, top = np.maximum(low, 0).tolist()
    right, bottom = np.minimum(high, [camera.width, camera.height]).tolist()
    if right - left < 2 or bottom - top < 2:
        return None
    part = (slice(None), slice(top, bottom), slice(left, right))
    return MarkerWindow(
        top, left, rim, {name: rates[part] for name, rates in lit.items()}, others[part]
    )


def expose_windows(
    image: Image,
    windows: Sequence[MarkerWindow | None],
    scenario: Scenario,
    camera: Camera,
    exposure: Exposure,
    exposure_ms: float,
    run: int,
) -> Image:
    """Return an image with the noise of a run round its markers.

    Parameters
    ----------
    image : (height, width) uint16 array, DN
        The frame as it was exposed once; it is not changed.
    windows : sequence of MarkerWindow or None
        By marker.
    scenario : Scenario
        With its lens, its chip, and what has drifted.
    camera : Camera
    exposure : Exposure
    exposure_ms : float, ms
    run : int
        Keys the noise, with frame, band and marker.

    Returns
    -------
    (height, width) uint16 array, DN.
    """
    shown = image.copy()
    optics, detector = scenario.simulated_optics, scenario.simulated_detector
    drift = Drift.of(scenario.drift, run)
    for marker, window in enumerate(windows):
        if window is None:
            continue
        rates = _as_now(window, drift, camera)
        charges = [
            mean_electrons(rate, exposure_ms, camera, optics, detector, None, drift, window.part)
            for rate in rates
        ]
        mean_e = mosaicked(charges) if len(charges) > 1 else charges[0]
        inner, place = _inside(window, image.shape)
        rng = exposure_rng(run, exposure.frame, exposure.band, WINDOW_DRAW, marker)
        shown[place] = expose_electrons(mean_e[inner], detector, rng)
    return shown


def _as_now(window: MarkerWindow, drift: Drift | None, camera: Camera) -> AnyArray:
    """Return the light of a window with its lamps as they now are, (planes, height, width)."""
    rates = window.others.astype(np.float32)
    for name, lamp in window.lamps.items():
        factor = 1.0 if drift is None else drift.of_lamp(name, camera, window.part)
        rates = rates + (lamp * factor).astype(np.float32)
    return rates


def _inside(window: MarkerWindow, shape: tuple[int, ...]) -> tuple[Part, Part]:
    """Return what is drawn again of a window: its rows and columns in it, and in the image."""
    inner, place = [], []
    for first, size, most in zip(
        (window.top, window.left), window.others.shape[1:], shape, strict=True
    ):
        low = 0 if first == 0 else window.rim
        high = size if first + size == most else size - window.rim
        inner.append(slice(low, high))
        place.append(slice(first + low, first + high))
    return (inner[0], inner[1]), (place[0], place[1])
