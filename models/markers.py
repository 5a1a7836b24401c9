"""The known markers of a target: where they lie, where they face, how large they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats

UNIT_TOLERANCE = 1e-6  # a normal typed with seven digits passes
SQUARE_TOLERANCE = 0.02  # cosine between an edge and its normal: surveys are a degree off


@dataclass(frozen=True)
class CornerCubes:
    """What a mission knows of its retroreflectors: solid cubes behind round faces.

    Attributes
    ----------
    refractive_index : float
        Of the glass, at the lamps' wavelength.
    edge_share : float
        Half-width of the dark line that an edge's bevel and its image make, over the radius.
    edges_in_target : (n, 3) array or None
        Unit vectors along each face, over one of the cube's three edges; None where nobody knows
        how the cubes are turned about their normals.

    Raises
    ------
    ValueError
        If the glass bends no light, a line is wider than the face, or an edge has not length one.
    """

    refractive_index: float
    edge_share: float
    edges_in_target: Floats | None = None

    def __post_init__(self) -> None:
        if not 1.0 < self.refractive_index < 5.0 or not 0.0 <= self.edge_share < 0.5:
            raise ValueError(
                "expected a refractive index between 1 and 5 and edges below half the radius, "
                f"got {self.refractive_index} and {self.edge_share}"
            )
        if self.edges_in_target is not None:
            lengths = np.linalg.norm(self.edges_in_target, axis=-1)
            if not (np.abs(lengths - 1.0) <= UNIT_TOLERANCE).all():
                raise ValueError(f"expected edges of length one, got lengths {lengths.tolist()}")


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
    cubes : CornerCubes or None
        Of retroreflectors; None where nobody says what they are, and they pass for even discs.

    Raises
    ------
    ValueError
        If a shape is wrong, a name comes twice, a normal has not length one, the radius is not
        positive, a value is not finite, or a cube's edge does not lie along its face.
    """

    names: tuple[str, ...]
    points_in_target: Floats
    normals_in_target: Floats
    radius_m: float
    paint: str = ""
    cubes: CornerCubes | None = None

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
        edges = None if self.cubes is None else self.cubes.edges_in_target
        if edges is not None:
            if edges.shape != shape:
                raise ValueError(f"expected edges of shape {shape}, got {edges.shape}")
            slants = (edges * self.normals_in_target).sum(axis=1)
            if not (np.abs(slants) <= SQUARE_TOLERANCE).all():
                raise ValueError(
                    "expected each cube's edge square to its normal, "
                    f"got cosines of {slants.tolist()}"
                )

    def __len__(self) -> int:
        return len(self.names)

    @property
    def min_separation_m(self) -> float:
        """Distance between the two nearest markers, m; infinite where there is but one."""
        gaps = np.linalg.norm(
            self.points_in_target[:, None] - self.points_in_target[None, :], axis=-1
        )
        return float(gaps[np.triu_indices(len(self), 1)].min(initial=np.inf))
