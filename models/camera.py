"""The pinhole camera with Brown-Conrady distortion, and both cameras of Opromolla 2022.

Axes are OpenCV's: x right, y down, z forward. Pixel centres are integers, so the middle of a
2048 x 2048 image is (1023.5, 1023.5) and the image spans [-0.5, 2047.5].
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import tomli_w
from numpy.typing import ArrayLike

from models.arrays import Floats, Mask
from models.distortion_fold import fold_radius
from models.errors import ScenarioError, UnreadableError, cause
from models.reading.shown import shown
from models.reading.toml_file import read_toml

UNDISTORT_TOLERANCE = 1e-12  # in normalised coordinates: 2e-9 px at f = 2196 px
UNDISTORT_ITERATIONS = 50
LARGEST_SIDE_PX = 16384  # no chip in flight is wider; a pair of such images is 1 GB
FOCAL_SIDES = (1e-3, 1e4)  # focal length over the image's side: 179.8 deg to 0.006 deg of view
FARTHEST_CENTRE_PX = 2.0 * LARGEST_SIDE_PX  # a window cut out of the largest image
LARGEST_COEFFICIENT = 1e6  # a lens of 0.5 deg whose k3 bends its corners by nothing has less
DISTORTION_ORDER = ("k1", "k2", "p1", "p2", "k3")  # OpenCV's


@dataclass(frozen=True)
class Camera:
    """A calibrated camera.

    Attributes
    ----------
    width, height : int, px
    fx, fy : float, px
        Focal lengths.
    cx, cy : float, px
        Principal point; pixel centres are integers.
    k1, k2, p1, p2, k3 : float
        Brown-Conrady coefficients in OpenCV's order and sense.

    A distortion is one-to-one out to ``fold_radius``. The image must lie within it; what lies
    beyond has no projection.

    Raises
    ------
    ScenarioError
        If a value is not finite or out of range, or the distortion folds over inside the image.
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0
    k3: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise ScenarioError(
                    f"camera: expected a number for {field.name}, got {shown(value)}"
                )
            if isinstance(value, float) and not np.isfinite(value):
                raise ScenarioError(f"camera: expected a finite {field.name}, got {value}")
        for name in ("width", "height", "fx", "fy"):
            if getattr(self, name) <= 0:
                raise ScenarioError(
                    f"camera: expected {name} in px above zero, got {shown(getattr(self, name))}"
                )
        self._require_ranges()
        if self.distorted:
            self._require_one_to_one()

    def _require_ranges(self) -> None:
        for name in ("width", "height"):
            self._require(name, 1, LARGEST_SIDE_PX, "px, the widest chip there is")
        for name, side in (("fx", self.width), ("fy", self.height)):
            low, high = (share * side for share in FOCAL_SIDES)
            self._require(name, low, high, "px, views of 180 deg to 0.006 deg")
        for name in ("cx", "cy"):
            far = FARTHEST_CENTRE_PX
            self._require(name, -far, far, "px, a window cut out of the widest chip")
        for name in DISTORTION_ORDER:
            most = LARGEST_COEFFICIENT
            self._require(name, -most, most, "in units of the focal length")

    def _require(self, name: str, low: float, high: float, meaning: str) -> None:
        value = getattr(self, name)
        if not low <= value <= high:
            raise ScenarioError(
                f"camera: expected {name} from {low:g} to {high:g} ({meaning}), got {shown(value)}"
            )

    def _require_one_to_one(self) -> None:
        try:
            self.normalise(self.spread_px())
        except ValueError as error:
            told = ", ".join(f"{name} {getattr(self, name):g}" for name in DISTORTION_ORDER)
            off_axis_deg = np.rad2deg(np.arctan(self.fold_radius))
            raise ScenarioError(
                f"camera: expected a distortion that is one-to-one over the image, got {told}, "
                f"which folds over {off_axis_deg:.1f} deg off axis, inside the {self.width} x "
                f"{self.height} px at fx {self.fx:g}, fy {self.fy:g}; check the coefficients, "
                "their order (k1, k2, p1, p2, k3) and their signs"
            ) from error

    @classmethod
    def from_fov(cls, width: int, height: int, fov_deg: float) -> Camera:
        """Build an undistorted camera from its horizontal field of view, centred.

        Parameters
        ----------
        width, height : int, px
        fov_deg : float, deg
            From the left edge of the image to the right one, in (0, 180).
        """
        if not 0.0 < fov_deg < 180.0:
            raise ScenarioError(f"camera: expected fov_deg between 0 and 180, got {fov_deg}")
        focal = float(0.5 * width / np.tan(np.deg2rad(0.5 * fov_deg)))
        return cls(width, height, focal, focal, 0.5 * (width - 1), 0.5 * (height - 1))

    @property
    def distortion(self) -> Floats:
        """(5,) array: k1, k2, p1, p2, k3, as OpenCV orders them."""
        return np.array([self.k1, self.k2, self.p1, self.p2, self.k3])

    @property
    def distorted(self) -> bool:
        """Whether any coefficient is not zero."""
        return bool(self.distortion.any())

    @cached_property
    def fold_radius(self) -> float:
        """Undistorted normalised radius within which no two directions share a pixel.

        Infinite without distortion, and for one that never folds; see ``models.distortion_fold``.
        """
        if not self.distorted:
            return np.inf
        return fold_radius(self.k1, self.k2, self.p1, self.p2, self.k3)

    @property
    def matrix(self) -> Floats:
        """(3, 3) array, px: the calibration matrix K."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])

    def resized(self, width: int) -> Camera:
        """Return the same optics on ``width`` columns, pixels larger or smaller to fit."""
        scale = width / self.width
        height = round(self.height * scale)
        return replace(
            self,
            width=width,
            height=height,
            fx=self.fx * scale,
            fy=self.fy * scale,
            cx=(self.cx + 0.5) * scale - 0.5,
            cy=(self.cy + 0.5) * scale - 0.5,
        )

    def distort(self, normalised: ArrayLike) -> Floats:
        """Map undistorted normalised coordinates (n, 2) to distorted ones (Brown 1966).

        The polynomial alone: beyond ``fold_radius`` it comes back to where nearer points are.
        """
        ideal = np.asarray(normalised, dtype=np.float64)
        if not self.distorted:
            return ideal.copy()
        x, y = np.moveaxis(ideal, -1, 0)
        r2 = x * x + y * y
        radial = 1.0 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3))
        return np.stack(
            [
                x * radial + 2.0 * self.p1 * x * y + self.p2 * (r2 + 2.0 * x * x),
                y * radial + self.p1 * (r2 + 2.0 * y * y) + 2.0 * self.p2 * x * y,
            ],
            axis=-1,
        )

    def undistort(self, normalised: ArrayLike) -> Floats:
        """Map distorted normalised coordinates (n, 2) to undistorted ones, by Newton's method.

        A NaN stays NaN.

        Raises
        ------
        ValueError
            If it does not converge, or only beyond the fold: no direction has such a pixel.
        """
        distorted = np.asarray(normalised, dtype=np.float64)
        guess = distorted.copy()
        if not self.distorted:
            return guess
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            for _ in range(UNDISTORT_ITERATIONS):
                xx, xy, yy = self._distortion_slopes(guess)
                determinant = xx * yy - xy * xy
                error_x, error_y = np.moveaxis(distorted - self.distort(guess), -1, 0)
                step = np.stack([yy * error_x - xy * error_y, xx * error_y - xy * error_x], axis=-1)
                step /= determinant[..., None]
                guess = guess + step
                settled = (np.abs(step) <= UNDISTORT_TOLERANCE).all(axis=-1)
                undone = settled & (determinant > 0.0) & (xx + yy > 0.0)
                undone &= np.hypot(*np.moveaxis(guess, -1, 0)) < self.fold_radius
                undone |= ~np.isfinite(distorted).all(axis=-1)
                if undone.all():
                    return guess
        raise ValueError(
            "expected a distortion that can be undone over the image; "
            f"{np.count_nonzero(~undone)} of {undone.size} points have no way back; "
            "check the coefficients' order (k1, k2, p1, p2, k3)"
        )

    def _distortion_slopes(self, normalised: Floats) -> tuple[Floats, Floats, Floats]:
        """Return dx'/dx, dx'/dy = dy'/dx and dy'/dy of ``distort``; the matrix is symmetric."""
        x, y = np.moveaxis(normalised, -1, 0)
        r2 = x * x + y * y
        radial = 1.0 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3))
        slope = 2.0 * (self.k1 + r2 * (2.0 * self.k2 + r2 * 3.0 * self.k3))
        return (
            radial + x * x * slope + 2.0 * self.p1 * y + 6.0 * self.p2 * x,
            x * y * slope + 2.0 * self.p1 * x + 2.0 * self.p2 * y,
            radial + y * y * slope + 6.0 * self.p1 * y + 2.0 * self.p2 * x,
        )

    def project(self, points_in_cam: ArrayLike) -> Floats:
        """Project points in front of the camera.

        Parameters
        ----------
        points_in_cam : (n, 3) or (3,) array, m

        Returns
        -------
        (n, 2) or (2,) array, px; NaN for a point that is not in front of the camera, or so far off
        axis that the distortion has folded over.
        """
        points = np.asarray(points_in_cam, dtype=np.float64)
        depth = np.where(points[..., 2:] > 0.0, points[..., 2:], np.nan)
        ideal = points[..., :2] / depth
        if self.distorted:
            seen = np.hypot(ideal[..., :1], ideal[..., 1:]) < self.fold_radius
            ideal = np.where(seen, ideal, np.nan)
        distorted = self.distort(ideal)
        return distorted * [self.fx, self.fy] + [self.cx, self.cy]

    def normalise(self, points_px: ArrayLike) -> Floats:
        """Return undistorted normalised coordinates (n, 2) of pixels (n, 2)."""
        pixels = np.asarray(points_px, dtype=np.float64)
        return self.undistort((pixels - [self.cx, self.cy]) / [self.fx, self.fy])

    def rays(self, points_px: ArrayLike) -> Floats:
        """Return unit directions in cam, (n, 3), through pixels (n, 2)."""
        normalised = self.normalise(points_px)
        directions = np.concatenate([normalised, np.ones((*normalised.shape[:-1], 1))], axis=-1)
        return directions / np.linalg.norm(directions, axis=-1, keepdims=True)

    def spread_px(self, steps: int = 8) -> Floats:
        """Return pixels spread evenly over the image, corners and all, (n, 2): steps + 1 a side."""
        across = np.linspace(-0.5, self.width - 0.5, steps + 1)
        down = np.linspace(-0.5, self.height - 0.5, steps + 1)
        return np.stack(np.meshgrid(across, down), axis=-1).reshape(-1, 2)

    def contains(self, points_px: ArrayLike, margin_px: float = 0.0) -> Mask:
        """Tell which pixels (n, 2) lie in the image, at least ``margin_px`` from its edge."""
        u, v = np.moveaxis(np.asarray(points_px, dtype=np.float64), -1, 0)
        low, right, bottom = margin_px - 0.5, self.width - 0.5, self.height - 0.5
        inside = (u >= low) & (u <= right - margin_px) & (v >= low) & (v <= bottom - margin_px)
        return np.asarray(inside)

    def to_toml(self) -> str:
        """Write the camera as TOML text that ``from_toml`` reads back exactly."""
        return tomli_w.dumps(asdict(self))

    @classmethod
    def from_toml(cls, path: Path) -> Camera:
        """Read a camera file.

        Raises
        ------
        ScenarioError
            If the file is missing, is not TOML, or has an unknown or a missing key.
        """
        try:
            table = read_toml(path)
        except UnreadableError as error:
            raise ScenarioError(
                f"{path}: expected a camera as TOML, got: {cause(error)}"
            ) from error
        known = {field.name for field in fields(cls)}
        unknown = [shown(key)[1:-1] for key in sorted(set(table) - known)[:10]]
        missing = sorted({"width", "height", "fx", "fy", "cx", "cy"} - set(table))
        if unknown or missing:
            raise ScenarioError(
                f"{path}: expected the camera keys {', '.join(sorted(known))}; "
                f"unknown: {', '.join(unknown) or 'none'}; missing: {', '.join(missing) or 'none'}"
            )
        for key in ("width", "height"):
            if not isinstance(table[key], int):
                raise ScenarioError(f"{path}: expected an integer {key}, got {shown(table[key])}")
        try:
            return cls(**table)
        except ScenarioError as error:
            raise ScenarioError(f"{path}: {str(error).removeprefix('camera: ')}") from error


CAMERAS: dict[str, Camera] = {
    # Opromolla et al. 2022, Tables 1 and 3. The field of view decides, see the reference tables.
    "chaser_fixed": Camera.from_fov(2048, 2048, 50.0),
    "eye_in_hand": Camera.from_fov(2048, 2048, 45.0),
    # Capuano et al. 2018 (VINAG), section 4.2: a lens of +-50 deg, two formats.
    "vinag_1080p": Camera.from_fov(1920, 1080, 100.0),
    "vinag_720p": Camera.from_fov(1280, 720, 100.0),
}


def camera_preset(name: str) -> Camera:
    """Return a camera by name.

    Raises
    ------
    ScenarioError
        If no preset has that name; the message lists those there are.
    """
    if name not in CAMERAS:
        raise ScenarioError(
            f"expected a camera preset among {', '.join(sorted(CAMERAS))}, got {name!r}"
        )
    return CAMERAS[name]
