"""The known markers of a target: where they lie, where they face, how large they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats

UNIT_TOLERANCE = 1e-6  # a normal typed with seven digits passes


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
    paint : str
        Material of the discs; empty for retroreflectors.

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
    paint: str = ""

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
