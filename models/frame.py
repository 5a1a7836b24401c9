"""What a pipeline may see, and nothing else: the first brick of the truth wall."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Image
from models.camera import Camera
from models.errors import DatasetError
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector

UNIT_TOLERANCE = 1e-6  # a normal typed with seven digits passes


@dataclass(frozen=True)
class Frame:
    """One image pair, as a flight computer gets it.

    Attributes
    ----------
    index : int
        Number of the frame in its dataset.
    time_s : float, s
        Middle of the 850 nm exposure, to which an estimate is stamped.
    image_800, image_850 : (height, width) uint16 arrays, DN
        The pair, 800 nm lamps first.
    exposure_ms : float, ms
        Exposure time of both images.
    """

    index: int
    time_s: float
    image_800: Image
    image_850: Image
    exposure_ms: float

    def __post_init__(self) -> None:
        for name in ("image_800", "image_850"):
            image = getattr(self, name)
            if image.ndim != 2 or image.dtype != np.uint16:
                raise DatasetError(
                    f"frame {self.index}: expected {name} as a (height, width) uint16 image, "
                    f"got shape {image.shape} of {image.dtype}"
                )
        if self.image_800.shape != self.image_850.shape:
            raise DatasetError(
                f"frame {self.index}: expected two images of one size, "
                f"got {self.image_800.shape} at 800 nm and {self.image_850.shape} at 850 nm"
            )


@dataclass(frozen=True)
class MarkerPattern:
    """The known markers of a target.

    Attributes
    ----------
    names : tuple of str
        Marker names, as the papers number them.
    points_in_target : (n, 3) array, m
        Centres.
    normals_in_target : (n, 3) array
        Unit outward normals.
    radius_m : float, m
        Radius of every disc.

    Raises
    ------
    ValueError
        If a shape is wrong, a name comes twice, a normal has not length one, the radius is not
        positive or a value is not finite.
    """

    names: tuple[str, ...]
    points_in_target: Floats
    normals_in_target: Floats
    radius_m: float

    def __post_init__(self) -> None:
        shape = (len(self.names), 3)
        if self.points_in_target.shape != shape or self.normals_in_target.shape != shape:
            raise ValueError(
                f"expected {len(self.names)} points and normals of shape {shape}, got "
                f"{self.points_in_target.shape} and {self.normals_in_target.shape}"
            )
        if len(set(self.names)) < len(self.names):
            raise ValueError(f"expected each marker's name once, got {', '.join(self.names)}")
        if not np.isfinite(self.points_in_target).all() or not 0.0 < self.radius_m < np.inf:
            raise ValueError(
                "expected finite points and a radius in m above zero, "
                f"got a radius of {self.radius_m} and points {self.points_in_target.tolist()}"
            )
        lengths = np.linalg.norm(self.normals_in_target, axis=1)
        if not (np.abs(lengths - 1.0) <= UNIT_TOLERANCE).all():
            raise ValueError(f"expected normals of length one, got lengths {lengths.tolist()}")

    def __len__(self) -> int:
        return len(self.names)

    @property
    def min_separation_m(self) -> float:
        """Distance between the two nearest markers, m; infinite where there is but one."""
        gaps = np.linalg.norm(
            self.points_in_target[:, None] - self.points_in_target[None, :], axis=-1
        )
        return float(gaps[np.triu_indices(len(self), 1)].min(initial=np.inf))


@dataclass(frozen=True)
class FlightKnowledge:
    """What is loaded on board before the first frame.

    Attributes
    ----------
    camera : Camera
        As calibrated, not as simulated.
    detector : Detector
        Gain, bias, read noise and full well, as calibrated.
    markers : MarkerPattern
        As surveyed, not as installed.
    prior : RigidTransform
        ``cam_from_target`` at the first frame, as drawn.
    prior_sigma_m : (3,) array, m
    prior_sigma_deg : (3,) array, deg
        The prior's 1-sigma in translation and in (alpha, beta, gamma).
    """

    camera: Camera
    detector: Detector
    markers: MarkerPattern
    prior: RigidTransform
    prior_sigma_m: Floats
    prior_sigma_deg: Floats
