"""The pose of a known target from one image, without any earlier one.

Every view of the target is compared with the image's lit part and its edges; the likeliest are
laid on the edges, first roughly on a coarse image, then the best of them on a fine one; each is
held against the image anew; and the best is believed if it fits, and fits clearly better than any
other that is not the same by symmetry.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Image
from models.camera import Camera
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from models.wireframe.wireframe import Wireframe
from pipelines.acquisition.view_search import PARTLY_LIT, Hypothesis, search_views
from pipelines.acquisition.view_sphere import view_sphere
from pipelines.detection.edge_map import find_edges
from pipelines.detection.target_region import find_target
from pipelines.tracking.edge_fit import EdgeFit, EdgeImage, fit_edges
from pipelines.tracking.model_edges import ModelEdges
from pipelines.tracking.pose_check import PoseCheck, check_pose

RANGE_STEP = 1.5  # of the ladder of ranges from which views are made


@dataclass(frozen=True)
class ImageAcquisitionOptions:
    """How thoroughly to look, and what to believe.

    Attributes
    ----------
    coarse_width, fine_width : int, px
        Images wider than this are reduced, for the search and for the last fit.
    about_deg : float
        How far a best pose that is not sure is turned, to be laid on the image again.
    directions : int
        From how many the target is seen, off-line.
    views : int
        How many of the likeliest are laid on the coarse image,
    finalists : int
        and how many of these on the fine one.
    sure_score : float
        Of ``PoseCheck``: where the best has less, much of the target may be in the dark, and
    more_views : int
        of the likeliest are tried with size and place varied widely.
    least_score : float
        Of ``PoseCheck``: less fits no image.
    least_supported, most_outside : float
        Share of the edges in light that must be found, and of the light that may lie outside of
        the silhouette, whatever the score.
    margin : float
        By how much the best must beat the next that is another pose, relative.
    apart_deg, apart_share : float
        Poses further apart than this, or than this share of the range, are different.
    """

    coarse_width: int = 512
    fine_width: int = 1024
    directions: int = 800
    views: int = 40
    finalists: int = 6
    sure_score: float = 0.75
    more_views: int = 40
    coarse_reaches_px: tuple[float, ...] = (16.0, 10.0, 5.0)
    fine_reaches_px: tuple[float, ...] = (8.0, 5.0, 4.0)
    least_score: float = 0.5
    least_supported: float = 0.75
    most_outside: float = 0.1
    margin: float = 0.05
    apart_deg: float = 5.0
    about_deg: float = 5.0
    apart_share: float = 0.05


@dataclass(frozen=True, eq=False)
class FoundPose:
    """A pose laid on an image, and how it fits."""

    fit: EdgeFit
    check: PoseCheck


@dataclass(frozen=True, eq=False)
class ImageAcquisition:
    """What an acquisition came to.

    Attributes
    ----------
    found : FoundPose or None
    reason : str
        Why there is none; empty where there is one.
    others : tuple of FoundPose
        The next best that are different poses, best first.
    rivals : tuple of FoundPose
        Those that fit alike, so that none is taken; none where there is another reason.
    """

    found: FoundPose | None
    reason: str
    others: tuple[FoundPose, ...] = field(default=())
    rivals: tuple[FoundPose, ...] = field(default=())


def reduced(image: Image, camera: Camera, width: int) -> tuple[Image, Camera]:
    """Return an image and its camera with pixels averaged, no wider than ``width``.

    Parameters
    ----------
    image : (height, width) array, DN
    camera : Camera
    width : int, px

    Returns
    -------
    image : (height, width) array, DN
    camera : Camera
        Of the image that is returned.
    """
    if image.shape[1] <= width:
        return image, camera
    small = camera.resized(width)
    size = (small.width, small.height)
    mean = cv2.resize(image.astype(np.float32), size, interpolation=cv2.INTER_AREA)
    return np.rint(mean).astype(np.uint16), small


def edge_image(image: Image, camera: Camera, detector: Detector | None, width: int) -> EdgeImage:
    """Find the target and its edges in an image, reduced to ``width``.

    Parameters
    ----------
    image : (height, width) array, DN
    camera : Camera
    detector : Detector or None
        As calibrated: gives the least noise there can be, and what saturated means.
    width : int, px
    """
    pixels, small = reduced(image, camera, width)
    target = find_target(pixels, detector)
    return EdgeImage(target, find_edges(target, detector), small)


class ImageAcquirer:
    """Acquires one target; its views are made at the first image and kept.

    Parameters
    ----------
    wireframe : Wireframe
    camera : Camera
    detector : Detector or None
    range_m : (float, float) or None, m
        Nearest and farthest, if known.
    options : ImageAcquisitionOptions
    """

    def __init__(
        self,
        wireframe: Wireframe,
        camera: Camera,
        detector: Detector | None,
        range_m: tuple[float, float] | None,
        options: ImageAcquisitionOptions,
    ) -> None:
        self._wireframe = wireframe
        self._camera = camera
        self._detector = detector
        self._range_m = range_m
        self._options = options
        self._coarse_edges = ModelEdges(wireframe, 400)
        self._edges = ModelEdges(wireframe)

    def acquire(self, image: Image) -> ImageAcquisition:
        """Find the pose in an image, (height, width) uint16 DN."""
        options = self._options
        coarse = edge_image(image, self._camera, self._detector, options.coarse_width)
        if not coarse.target:
            return ImageAcquisition(None, "nothing in the image stands out of the sky")
        sphere = view_sphere(self._wireframe, self._range_rung(coarse), options.directions)
        fine = edge_image(image, self._camera, self._detector, options.fine_width)
        finals = self._laid(search_views(coarse, sphere, options.views), coarse, fine)
        if not finals or finals[0].check.score < options.sure_score:
            views = search_views(coarse, sphere, options.more_views, PARTLY_LIT)
            finals = self._different([*finals, *self._laid(views, coarse, fine)])
        if finals and finals[0].check.score < options.sure_score:
            about = [one for best in finals[:2] for one in self._about(best, fine)]
            finals = self._different([*finals, *about])
        return self._judged(finals)

    def _about(self, found: FoundPose, fine: EdgeImage) -> list[FoundPose]:
        """Lay poses about a found one: turned a little, nearer and farther.

        Where wings are seen nearly end on, edges close together hold a pose some degrees off.
        """
        pose, options = found.fit.cam_from_target, self._options
        starts: list[RigidTransform] = []
        for axis in np.concatenate([np.eye(3), -np.eye(3)]):
            turn = np.deg2rad(options.about_deg) * axis
            starts.extend(pose.perturbed(turn, s * pose.translation) for s in (-0.03, 0.03))
        starts.extend(
            pose.perturbed(np.zeros(3), s * pose.translation) for s in (-0.07, -0.035, 0.035, 0.07)
        )
        laid = []
        for start in starts:
            fit = fit_edges(fine, self._edges, start, (12.0, *options.fine_reaches_px))
            if fit is not None and self._in_range(fit.cam_from_target):
                laid.append(FoundPose(fit, check_pose(fine, self._edges, fit.cam_from_target)))
        return laid

    def _laid(self, views: list[Hypothesis], coarse: EdgeImage, fine: EdgeImage) -> list[FoundPose]:
        """Lay views on the coarse image, and the best of them on the fine one."""
        options = self._options
        tried = []
        for view in views:
            fit = fit_edges(
                coarse, self._coarse_edges, view.cam_from_target, options.coarse_reaches_px
            )
            if fit is not None and self._in_range(fit.cam_from_target):
                check = check_pose(coarse, self._coarse_edges, fit.cam_from_target)
                tried.append(FoundPose(fit, check))
        finals = []
        for rough in self._different(tried)[: options.finalists]:
            fit = fit_edges(fine, self._edges, rough.fit.cam_from_target, options.fine_reaches_px)
            if fit is not None and self._in_range(fit.cam_from_target):
                finals.append(FoundPose(fit, check_pose(fine, self._edges, fit.cam_from_target)))
        return self._different(finals)

    def _judged(self, finals: list[FoundPose]) -> ImageAcquisition:
        if not finals:
            return ImageAcquisition(None, "no view of the target can be laid on the image's edges")
        best, others = finals[0], tuple(finals[1:])
        score, least = best.check.score, self._options.least_score
        if not self._believable(best.check):
            reason = (
                f"the best of all views does not fit the image: score {score:.2f} "
                f"(at least {least:.2f}), {100 * best.check.supported:.0f} % of its edges found "
                f"(at least {100 * self._options.least_supported:.0f} %), "
                f"{100 * best.check.outside:.0f} % of the light outside it "
                f"(at most {100 * self._options.most_outside:.0f} %)"
            )
            return ImageAcquisition(None, reason, tuple(finals))
        enough = (1.0 - self._options.margin) * score
        if others and others[0].check.score > enough:
            one, other = best.fit.cam_from_target, others[0].fit.cam_from_target
            turn = Rotation.from_matrix(one.rotation @ other.rotation.T)
            reason = (
                f"two poses fit alike ({score:.2f} and {others[0].check.score:.2f}), "
                f"{np.rad2deg(turn.magnitude()):.0f} deg and "
                f"{np.linalg.norm(one.translation - other.translation):.2f} m apart"
            )
            rivals = tuple(each for each in finals if each.check.score > enough)
            return ImageAcquisition(None, reason, tuple(finals), rivals)
        return ImageAcquisition(best, "", others)

    def _believable(self, check: PoseCheck) -> bool:
        options = self._options
        return (
            check.score >= options.least_score
            and check.supported >= options.least_supported
            and check.outside <= options.most_outside
        )

    def _different(self, found: list[FoundPose]) -> list[FoundPose]:
        """Sort poses, the best first, and keep one of each that are the same."""
        kept: list[FoundPose] = []
        for one in sorted(found, key=lambda each: -each.check.score):
            if not any(self._same(one.fit.cam_from_target, k.fit.cam_from_target) for k in kept):
                kept.append(one)
        return kept

    def _same(self, pose: RigidTransform, other: RigidTransform) -> bool:
        """Tell whether two poses are near each other, a symmetry of the target aside."""
        away = float(np.linalg.norm(pose.translation - other.translation))
        if away > self._options.apart_share * other.translation[2]:
            return False
        least = 1.0 + 2.0 * np.cos(np.deg2rad(self._options.apart_deg))
        turns = (np.eye(3), *self._wireframe.symmetries)
        return any(
            float(np.trace(pose.rotation @ turn @ other.rotation.T)) > least for turn in turns
        )

    def _in_range(self, pose: RigidTransform) -> bool:
        if self._range_m is None:
            return True
        nearest, farthest = self._range_m
        return bool(0.8 * nearest < pose.translation[2] < 1.25 * farthest)

    def _range_rung(self, image: EdgeImage) -> float:
        """Return a range of the right size for the perspective of the views.

        The wider the lit part, the nearer the target; seen end on it seems further than it is.
        """
        if self._range_m is not None:
            return float(np.sqrt(self._range_m[0] * self._range_m[1]))
        row, column = np.nonzero(image.target.lit)
        extent = max(float(np.ptp(row)), float(np.ptp(column)), 1.0)
        apparent = 1.5 * self._wireframe.radius_m * image.camera.fx / extent
        least = 1.5 * self._wireframe.radius_m
        rung = round(np.log(max(apparent, least) / least) / np.log(RANGE_STEP))
        return float(least * RANGE_STEP**rung)
