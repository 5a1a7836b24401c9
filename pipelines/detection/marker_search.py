"""Where to look: round the markers as a prediction sees them, or everywhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Mask
from models.camera import Camera
from models.markers import MarkerPattern
from models.sensors.camera_chip import Detector
from pipelines.detection.candidates import Candidates
from pipelines.detection.detection_options import DetectionOptions
from pipelines.detection.disc_outline import DiscOutlines, disc_outlines
from pipelines.detection.image_difference import Region
from pipelines.detection.image_pair import ImagePair
from pipelines.detection.local_threshold import detect_in_region
from pipelines.pnp.predicted_pose import PredictedPose
from pipelines.pnp.projection_jacobian import jacobian_by_turn

REGION_MARGIN_PX = 5.0
LARGEST_SHARE = 0.25  # of the image; above, regions save nothing
RANGE_SIGMAS = 3.0


@dataclass(frozen=True, eq=False)
class PredictedMarkers:
    """The markers as a prediction sees them.

    Attributes
    ----------
    outlines : DiscOutlines
    covariance_px2 : (n, 2, 2) array, px^2
        Of the predicted centres; infinite where a marker cannot be seen.
    radii_px : tuple of float, px
        Smallest and largest radius that any marker's image may have.
    """

    outlines: DiscOutlines
    covariance_px2: Floats
    radii_px: tuple[float, float]

    @property
    def radius_px(self) -> float:
        """Typical radius, px."""
        return float(np.sqrt(self.radii_px[0] * self.radii_px[1]))


def predict_markers(
    camera: Camera, markers: MarkerPattern, predicted: PredictedPose
) -> PredictedMarkers | None:
    """Project a predicted pose's markers and its uncertainty; None if none faces the camera.

    Parameters
    ----------
    camera : Camera
    markers : MarkerPattern
    predicted : PredictedPose
    """
    outlines = disc_outlines(camera, predicted.pose, markers)
    if not outlines.facing.any():
        return None
    pose, facing = predicted.pose, outlines.facing
    focal = np.array([[camera.fx], [camera.fy]])
    jacobian = focal * jacobian_by_turn(
        pose.rotation, pose.translation, markers.points_in_target[facing]
    )
    covariance = np.full((len(markers), 2, 2), np.nan)
    covariance[facing] = jacobian @ predicted.covariance @ jacobian.transpose(0, 2, 1)
    nearest = float(outlines.radii_px[facing].max())
    furthest = float(outlines.radii_px[facing].min())
    depth_sigma = float(np.sqrt(predicted.covariance[5, 5])) / max(pose.translation[2], 1e-3)
    slack = 1.0 + min(RANGE_SIGMAS * depth_sigma, 1.0)
    return PredictedMarkers(outlines, covariance, (furthest / slack, nearest * slack))


def region_half_sizes_px(
    predicted: PredictedMarkers, options: DetectionOptions, growth: float
) -> Floats:
    """Return the half width and half height round each predicted marker, (n, 2) px.

    Parameters
    ----------
    predicted : PredictedMarkers
    options : DetectionOptions
    growth : float
        Factor on what is added to the disc's own image, more after lost frames.
    """
    sigma = np.sqrt(np.diagonal(predicted.covariance_px2, axis1=1, axis2=2))
    slack = growth * (options.region_sigmas * sigma + REGION_MARGIN_PX)
    return np.asarray(predicted.outlines.half_extents_px + slack)


def marker_regions(
    camera: Camera, predicted: PredictedMarkers, options: DetectionOptions, growth: float
) -> list[Region]:
    """Return the regions round the predicted markers; none if they would be most of the image.

    Parameters
    ----------
    camera : Camera
    predicted : PredictedMarkers
    options : DetectionOptions
    growth : float
        Factor on what is added to the disc's own image, more after lost frames.
    """
    half = region_half_sizes_px(predicted, options, growth)
    regions = []
    for centre, reach in zip(predicted.outlines.centres_px, half, strict=True):
        if not (np.isfinite(centre).all() and np.isfinite(reach).all()):
            continue
        size = [camera.width, camera.height]
        low = np.clip(np.floor(centre - reach), 0, size).astype(int)
        high = np.clip(np.ceil(centre + reach) + 1, 0, size).astype(int)
        if (high > low).all():
            regions.append(Region(int(low[1]), int(high[1]), int(low[0]), int(high[0])))
    covered = sum(region.pixels for region in regions)
    return regions if covered < LARGEST_SHARE * camera.width * camera.height else []


def search(
    pair: ImagePair,
    camera: Camera,
    detector: Detector,
    predicted: PredictedMarkers,
    regions: list[Region],
    options: DetectionOptions,
) -> Candidates:
    """Find candidates in the regions, and drop those that the image's edge may cut.

    Parameters
    ----------
    pair : ImagePair
    camera : Camera
    detector : Detector
    predicted : PredictedMarkers
    regions : list of Region
    options : DetectionOptions
    """
    parts = [
        detect_in_region(pair, detector, region, predicted.radii_px, options) for region in regions
    ]
    found = Candidates.merged(parts, same_px=1.0)
    margin = options.s_bord * float(predicted.outlines.radii_px[predicted.outlines.facing].min())
    return found.kept(camera.contains(found.points_px.reshape(-1, 2), margin))


def pair_costs(points_px: Floats, predicted: PredictedMarkers, coarse_sigma_px: float) -> Floats:
    """Return the squared distance in sigmas of each candidate from each marker, (n, m).

    Parameters
    ----------
    points_px : (n, 2) array, px
    predicted : PredictedMarkers
        Of m markers; what cannot be seen costs infinity.
    coarse_sigma_px : float, px
        1 sigma of a candidate on each axis.
    """
    spread = predicted.covariance_px2 + coarse_sigma_px**2 * np.eye(2)
    away = points_px[:, None] - predicted.outlines.area_centres_px[None, :]
    seen = predicted.outlines.facing
    cost = np.full(away.shape[:2], np.inf)
    inverse = np.linalg.inv(spread[seen])
    cost[:, seen] = np.einsum("nmi,mij,nmj->nm", away[:, seen], inverse, away[:, seen])
    return cost


def within_gate(points_px: Floats, predicted: PredictedMarkers, gate_px: float) -> Mask:
    """Tell which candidates lie within a distance of which markers, (n, m).

    Parameters
    ----------
    points_px : (n, 2) array, px
    predicted : PredictedMarkers
        Of m markers.
    gate_px : float, px
    """
    gap = np.linalg.norm(points_px[:, None] - predicted.outlines.centres_px[None, :], axis=-1)
    return np.asarray(np.nan_to_num(gap, nan=np.inf) < gate_px)
