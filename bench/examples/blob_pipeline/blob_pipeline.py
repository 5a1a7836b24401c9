"""A pipeline of another package: bright blobs, the nearest markers, OpenCV's solver."""

import cv2
import numpy as np

from models.arrays import Floats, Image
from models.estimate import Estimate, PoseEstimate
from models.frame import IMAGE_800, IMAGE_850, Frame
from models.onboard import OnboardKnowledge, needed
from models.pose import RigidTransform
from pipelines.pipeline import RegisteredPipeline

NAME, NO_LENS = "blob", np.eye(3)
THRESHOLD_SIGMA, LEAST_PIXELS, LEAST_MATCHES, KEPT_PX, FAR_PX = 12.0, 4, 5, 2.0, 1e9


class BlobPipeline:
    """What shines at 850 nm alone, nearest to where a marker is expected, is that marker."""

    def __init__(self, onboard: OnboardKnowledge, variant: str) -> None:
        self.camera = needed(onboard.camera, "camera.toml", NAME)
        self.points_in_target = needed(onboard.markers, "markers.toml", NAME).points_in_target
        self.pose = needed(onboard.prior, "prior.toml", NAME).cam_from_target

    def process(self, frame: Frame) -> Estimate:
        """Return the pose of a frame, or why there is none."""
        blobs_px = blobs_in(*(frame.image(stream).image for stream in (IMAGE_850, IMAGE_800)))
        markers_px = self.camera.project(self.pose @ self.points_in_target)
        apart = np.nan_to_num(np.linalg.norm(markers_px[:, None] - blobs_px, axis=2), nan=FAR_PX)
        least = [apart.min(axis=each, keepdims=True, initial=FAR_PX) for each in (0, 1)]
        markers, blobs = np.nonzero((apart < FAR_PX) & (apart == least[0]) & (apart == least[1]))
        pose = self._solved(self.points_in_target[markers], self.camera.normalise(blobs_px[blobs]))
        if pose is None:
            return Estimate(frame.index, frame.time_s, reason=f"{len(markers)} blobs at markers")
        self.pose = pose
        return Estimate(frame.index, frame.time_s, PoseEstimate(pose))

    def _solved(self, points: Floats, rays: Floats) -> RigidTransform | None:
        if len(points) < LEAST_MATCHES:
            return None
        cv2.setRNGSeed(0)  # the same frames give the same estimates
        near = {"reprojectionError": KEPT_PX / self.camera.fx, "flags": cv2.SOLVEPNP_SQPNP}
        found, turn, shift, kept = cv2.solvePnPRansac(points, rays, NO_LENS, None, **near)
        if not found or len(kept) < LEAST_MATCHES:
            return None
        kept = kept.ravel()
        turn, shift = cv2.solvePnPRefineLM(points[kept], rays[kept], NO_LENS, None, turn, shift)
        return RigidTransform(cv2.Rodrigues(turn)[0], shift.ravel())


def blobs_in(lit: Image, dark: Image) -> Floats:
    """Return the middles of what only the first of two images shows, (n, 2), px."""
    difference = cv2.GaussianBlur(lit.astype(np.float32) - dark, (3, 3), 0)
    mask = difference > THRESHOLD_SIGMA * max(1.0, np.median(np.abs(difference)))
    _, _, boxes, middles = cv2.connectedComponentsWithStats(mask.astype(np.uint8))
    return np.asarray(middles[1:][boxes[1:, cv2.CC_STAT_AREA] >= LEAST_PIXELS])


PIPELINE = RegisteredPipeline(NAME, BlobPipeline, streams=(IMAGE_800, IMAGE_850))
