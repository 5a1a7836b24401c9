"""The last step of the best variant: fit every marker where the pose says, and solve again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.camera import Camera
from models.markers import MarkerPattern
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from pipelines.chaser_fixed.options import ChaserFixedOptions
from pipelines.detection.cube_model import CubeFace
from pipelines.detection.cube_template import cube_template
from pipelines.detection.disc_fit import DiscFit, ExpectedBlur, fit_appearance, fit_disc
from pipelines.detection.disc_outline import DiscOutlines, disc_outlines
from pipelines.detection.disc_window import cut_window
from pipelines.detection.image_difference import saturation_level_dn
from pipelines.detection.image_pair import ImagePair
from pipelines.detection.pair_alignment import AlignedPatch, aligned_patch
from pipelines.pnp.match import Match

LEAST_RADIUS_PX = 0.9  # below, a disc has no edge to fit
LEAST_HEIGHT_SIGMAS = 8.0
SIZE_LIMITS = (0.75, 1.33)
CUT_SIZE = 0.9  # a cube that is cut from a side is fitted smaller,
EVEN_LIMITS = (-0.3, 1.3)  # and as if it returned more or less than this share evenly
FURTHEST_MOTION_PX = 2.0  # within a pair; beyond it the velocity is not to be believed
FURTHEST_RADII = 0.5  # a disc further from where the pose says is another thing


@dataclass(frozen=True, eq=False)
class FittedMarkers:
    """The discs that were fitted and believed.

    Attributes
    ----------
    match : Match
        Projections of the discs' centres: the perspective of a circle is taken off.
    blur_px, crosstalk : float
        What the fits found, for the next frame to start from.
    """

    match: Match
    blur_px: float
    crosstalk: float


def _believable(fit: DiscFit, radius_px: float, options: ChaserFixedOptions) -> bool:
    """Refuse what is faint, cut, of another size, or elsewhere."""
    reach = max(2.0, FURTHEST_RADII * radius_px)
    even = fit.parameters.shares[:1]
    foreseen = (even > EVEN_LIMITS[0]) & (even < EVEN_LIMITS[1])
    return bool(
        fit.parameters.height_dn > LEAST_HEIGHT_SIGMAS * fit.height_sigma_dn
        and fit.shape_misfit < options.max_misfit
        and SIZE_LIMITS[0] < fit.parameters.size < SIZE_LIMITS[1]
        and np.hypot(*fit.parameters.centre_px) < reach
        and (fit.parameters.size > CUT_SIZE or foreseen.all())
    )


def contrast_800(
    patch: AlignedPatch, centre_px: Floats, shape_px2: Floats, height_dn: float
) -> float:
    """Return how much a marker's face differs from its surround at 800 nm, over its height.

    That times the motion within the pair is how far the difference pulls the marker's centre.

    Parameters
    ----------
    patch : AlignedPatch
    centre_px : (2,) array, px
        Of the marker's outline, in the whole image.
    shape_px2 : (2, 2) array, px^2
        ``S`` of the outline ``d^T S^-1 d = 1``.
    height_dn : float, DN
        Of the disc, as fitted.
    """
    v, u = np.indices(patch.image_800.shape)
    away = np.stack([u, v], axis=-1) + patch.corner_px - centre_px
    ellipse = np.einsum("...i,ij,...j->...", away, np.linalg.inv(shape_px2), away)
    face, surround = patch.image_800[ellipse < 1.0], patch.image_800[ellipse >= 1.5]
    if not (len(face) and len(surround)):
        return 0.0
    return float(abs(np.mean(face) - np.median(surround)) / height_dn)


def fit_cube(
    patch: AlignedPatch,
    camera: Camera,
    pose: RigidTransform,
    markers: MarkerPattern,
    index: int,
    outlines: DiscOutlines,
    detector: Detector,
    saturation_dn: float,
    blur: ExpectedBlur,
) -> DiscFit | None:
    """Fit one marker as the cube that it is known to be; None if there is no such cube.

    Parameters
    ----------
    patch : AlignedPatch
    camera, pose, markers
    index : int
        Of the marker.
    outlines : DiscOutlines
        Of all markers.
    detector : Detector
    saturation_dn : float, DN
    blur : ExpectedBlur
    """
    centre, shape = outlines.centres_px[index], outlines.shapes_px2[index]
    half_extent = np.sqrt(np.diag(shape))
    template = cube_template(camera, pose, markers, index, centre, half_extent)
    window = cut_window(
        patch.image_800, patch.image_850, centre - patch.corner_px, half_extent, saturation_dn
    )
    if template is None or window is None:
        return None
    inverse: Floats = np.linalg.inv(shape).astype(np.float64)
    face = CubeFace(template, inverse, float(outlines.radii_px[index]))
    return fit_appearance(window, face, detector, blur)


def fit_markers(
    pair: ImagePair,
    camera: Camera,
    detector: Detector,
    markers: MarkerPattern,
    pose: RigidTransform,
    cam_from_target_800: RigidTransform | None,
    blur: ExpectedBlur,
    options: ChaserFixedOptions,
) -> FittedMarkers:
    """Fit all discs that a pose sees whole in the image and large enough, found before or not.

    Parameters
    ----------
    pair, camera, detector, markers
    pose : RigidTransform
        ``cam_from_target``, good to about a marker's radius.
    cam_from_target_800 : RigidTransform
        The same when the 800 nm image was taken; None where the velocity is unknown, and then
        what the motion may have left in the difference widens each covariance.
    blur : ExpectedBlur
    options : ChaserFixedOptions
    """
    outlines = disc_outlines(camera, pose, markers)
    motions = np.zeros((len(markers), 2))
    if cam_from_target_800 is not None:
        motions = camera.project(pose @ markers.points_in_target)
        motions = np.nan_to_num(
            motions - camera.project(cam_from_target_800 @ markers.points_in_target)
        )
    level = saturation_level_dn(detector)
    points: list[Floats] = []
    covariances: list[Floats] = []
    chosen: list[int] = []
    blurs: list[tuple[float, float]] = []
    for index in np.flatnonzero(outlines.facing):
        radius = float(outlines.radii_px[index])
        centre = outlines.area_centres_px[index]
        if radius < LEAST_RADIUS_PX or not camera.contains(centre, options.s_bord * radius):
            continue
        patch = aligned_patch(
            pair.image_800,
            pair.image_850,
            centre,
            np.sqrt(np.diag(outlines.shapes_px2[index])),
            np.clip(motions[index], -FURTHEST_MOTION_PX, FURTHEST_MOTION_PX),
            level,
        )
        if options.centroiding == "cube_fit" and markers.cubes is not None:
            fit = fit_cube(
                patch, camera, pose, markers, int(index), outlines, detector, level, blur
            )
        else:
            fit = fit_disc(
                patch.image_800,
                patch.image_850,
                centre - patch.corner_px,
                outlines.shapes_px2[index],
                detector,
                level,
                blur,
            )
        if fit is None or not _believable(fit, radius, options):
            continue
        points.append(outlines.centres_px[index] + fit.parameters.centre_px)
        variance_px2 = options.centroid_floor_px**2
        if cam_from_target_800 is None:
            pull = contrast_800(patch, centre, outlines.shapes_px2[index], fit.parameters.height_dn)
            unknown_px = camera.fx * options.velocity_m_s * options.pair_gap_s / pose.translation[2]
            variance_px2 += float(pull * unknown_px) ** 2
        covariances.append(fit.covariance_px2 + variance_px2 * np.eye(2))
        chosen.append(int(index))
        blurs.append((fit.parameters.blur_px, fit.parameters.crosstalk))
    middle = np.median(blurs, axis=0) if blurs else [blur.start_px, blur.start_crosstalk]
    match = Match(
        np.array(points).reshape(-1, 2),
        np.array(covariances).reshape(-1, 2, 2),
        np.array(chosen, dtype=np.int64),
    )
    return FittedMarkers(match, float(middle[0]), float(middle[1]))
