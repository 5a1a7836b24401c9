"""Every dot fitted by its rim where a pose has it, found before or not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Image
from models.camera import Camera
from models.markers import MarkerPattern
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from pipelines.detection.disc_outline import disc_outlines
from pipelines.detection.image_difference import saturation_level_dn
from pipelines.detection.lit_disc import KnownDisc, LitDisc, fit_lit_disc
from pipelines.pnp.match import Match

LEAST_RADIUS_PX = 2.5  # below, a rim has no sections to speak of
MOST_SIZE, SIZE_SIGMAS, ROUGHEST_SIZE = 0.07, 4.0, 0.35  # by which a dot may differ from the pose
FURTHEST_RADII = 0.6
MOST_CHI2 = 20.0
NO_CIRCLE_PX = -1e6


@dataclass(frozen=True, eq=False)
class FittedDots:
    """The dots that were fitted and believed.

    Attributes
    ----------
    match : Match
        Projections of their centres: the perspective of a circle is taken off.
    refused : dict of int to str
        Why each of the others was not.
    blur_px : float, px
        Of the lens, as the rims show it.
    worst_size : float
        Largest departure of a dot's size from the pose's, relative.
    furthest_px : float, px
        Largest shift of a dot from the pose.
    """

    match: Match
    refused: dict[int, str]
    blur_px: float
    worst_size: float
    furthest_px: float


def fit_dots(
    raw: Image,
    camera: Camera,
    detector: Detector,
    markers: MarkerPattern,
    pose: RigidTransform,
    centres_px: Floats,
    blur_px: float,
    known: KnownDisc,
    sizes: Floats | None = None,
) -> FittedDots:
    """Fit all dots that a pose sees whole in the image and large enough.

    Parameters
    ----------
    raw : (height, width) uint16 array, DN
    camera, detector, markers
    pose : RigidTransform
        ``cam_from_target``: tells the outlines' shapes.
    centres_px : (n, 2) array, px
        Where the outlines' middles are looked for; NaN takes the pose's own, ``NO_CIRCLE_PX``
        leaves a dot out.
    blur_px : float, px
        Expected 1-sigma of the lens's blur.
    known : KnownDisc
        How well the pose tells the outlines.
    sizes : (n,) array, optional
        Their sizes as they were seen, over those by the pose; 1 unless given.
    """
    outlines = disc_outlines(camera, pose, markers)
    level = saturation_level_dn(detector)
    points: list[Floats] = []
    covariances: list[Floats] = []
    chosen: list[int] = []
    fits: list[LitDisc] = []
    refused: dict[int, str] = {}
    for index in range(len(markers)):
        if not outlines.facing[index]:
            refused[index] = "it does not face the camera"
            continue
        radius = float(outlines.radii_px[index])
        by_pose = outlines.area_centres_px[index]
        centre = centres_px[index] if np.isfinite(centres_px[index]).all() else by_pose
        if centre[0] == NO_CIRCLE_PX:
            refused[index] = "no circle is taken for it"
        elif radius < LEAST_RADIUS_PX:
            refused[index] = f"its radius is {radius:.1f} px"
        elif not camera.contains(centre, radius + 2.0):
            refused[index] = "the image cuts it"
        else:
            seen = 1.0 if sizes is None else float(sizes[index])
            shape = seen**2 * outlines.shapes_px2[index]
            fit = fit_lit_disc(raw, detector, level, centre, shape, blur_px, known)
            wrong = fit if isinstance(fit, str) else _unbelievable(fit, radius, known)
            if wrong or isinstance(fit, str):
                refused[index] = wrong
                continue
            offset = outlines.centres_px[index] - by_pose
            points.append(centre + fit.shift_px + offset)
            covariances.append(fit.covariance_px2)
            chosen.append(index)
            fits.append(fit)
    match = Match(
        np.array(points).reshape(-1, 2),
        np.array(covariances).reshape(-1, 2, 2),
        np.array(chosen, dtype=np.int64),
    )
    away = match.points_px - outlines.centres_px[match.marker]
    return FittedDots(
        match,
        refused,
        blur_px=float(np.median([fit.blur_px for fit in fits])) if fits else blur_px,
        worst_size=max((abs(fit.size - 1.0) for fit in fits), default=0.0),
        furthest_px=float(np.linalg.norm(away, axis=1).max(initial=0.0)),
    )


def _unbelievable(fit: LitDisc, radius_px: float, known: KnownDisc) -> str:
    """Say what is wrong with a fit; nothing if it can be believed."""
    if abs(fit.size - 1.0) > np.clip(SIZE_SIGMAS * known.size_sigma, MOST_SIZE, ROUGHEST_SIZE):
        return f"it is {fit.size:.2f} times as large as the pose has it"
    if float(np.hypot(*fit.shift_px)) > max(2.0, FURTHEST_RADII * radius_px):
        return "it lies elsewhere"
    if fit.misfit_chi2 > MOST_CHI2:
        return "its rim is no circle's"
    return ""
