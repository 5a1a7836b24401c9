"""How far an arm is from itself and from what stands around it, by capsules.

Between two capsules: the distance of their axes less both radii (closest points of two segments,
Ericson 2005, section 5.1.9). To a spacecraft: the least distance of points of the axes from
points of its surface, which tells a wall 3 cm from a tube of 11 cm at most 3 mm too far.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from models.arm.arm import Arm, Capsule
from models.arm.kinematics import chain
from models.arrays import AnyArray, Floats
from models.pose import RigidTransform
from models.spacecraft.part import Spacecraft

SAMPLED_M = 0.02  # from any place of a surface to one of its points
SQRT_3 = 3.0**0.5  # from a triangle's corner to its middle an edge is divided by this, at most
ALONG_M = 0.02  # from one point of a capsule's axis to the next
FAR_M = 0.25  # what is farther is not asked how far
PARALLEL = 1e-14  # squared sine, below which two axes run side by side


@dataclass(frozen=True)
class Nearest:
    """The two things that come nearest.

    Attributes
    ----------
    distance_m : float, m
        Between their surfaces; below zero they are in each other.
    first, second : str
        Names: of a capsule, and of another or of a part of a spacecraft.
    """

    distance_m: float
    first: str
    second: str

    def __str__(self) -> str:
        if self.distance_m < 0.0:
            return f"{self.first} would be {-self.distance_m:.3f} m inside {self.second}"
        return f"{self.first} would be {self.distance_m:.3f} m from {self.second}"


def axes_in_base(arm: Arm, angles_rad: ArrayLike) -> Floats:
    """Return the ends of every capsule's axis in the base's frame.

    Parameters
    ----------
    arm : Arm
    angles_rad : (n,) array, rad

    Returns
    -------
    (capsules, 2, 3) array, m
    """
    links = chain(arm, angles_rad)
    stands = links[[capsule.link for capsule in arm.capsules]]
    ends = np.array([[each.start_in_link, each.end_in_link] for each in arm.capsules])
    placed = np.einsum("kij,kej->kei", stands[:, :3, :3], ends) + stands[:, None, :3, 3]
    return np.asarray(placed)


def segment_distance(first: Floats, second: Floats) -> Floats:
    """Return the distance between segments, pair by pair.

    Parameters
    ----------
    first, second : (..., 2, 3) arrays, m
        Their ends; a segment may be a point.

    Returns
    -------
    (...,) array, m
    """
    p, q = first[..., 0, :], second[..., 0, :]
    u, v = first[..., 1, :] - p, second[..., 1, :] - q
    between = p - q
    a, e, b = _dot(u, u), _dot(v, v), _dot(u, v)
    c, f = _dot(u, between), _dot(v, between)
    crossed = a * e - b * b
    s = np.where(crossed > PARALLEL * a * e, _ratio(b * f - c * e, crossed), 0.0)
    s = np.clip(s, 0.0, 1.0)
    t = np.clip(_ratio(b * s + f, e), 0.0, 1.0)
    s = np.clip(_ratio(b * t - c, a), 0.0, 1.0)
    t = np.clip(_ratio(b * s + f, e), 0.0, 1.0)
    gap = between + s[..., None] * u - t[..., None] * v
    return np.linalg.norm(gap, axis=-1)


def nearest_of_itself(arm: Arm, angles_rad: ArrayLike) -> Nearest:
    """Return which two parts of an arm come nearest, but for those that are joined.

    Parts of one link, and of two that a joint joins, touch by design. So do those across a link
    shorter than the two are thick, such as a wrist's.

    Parameters
    ----------
    arm : Arm
    angles_rad : (n,) array, rad
    """
    axes = axes_in_base(arm, angles_rad)
    pairs = apart(arm.capsules)
    if not pairs:
        return Nearest(np.inf, arm.name, arm.name)
    one, other = np.array(pairs).T
    radii = np.array([capsule.radius_m for capsule in arm.capsules])
    gaps = segment_distance(axes[one], axes[other]) - radii[one] - radii[other]
    least = int(np.argmin(gaps))
    names = [capsule.name for capsule in arm.capsules]
    return Nearest(float(gaps[least]), names[one[least]], names[other[least]])


def apart(capsules: Sequence[Capsule]) -> list[tuple[int, int]]:
    """Return the pairs of capsules that must not touch; see ``nearest_of_itself``."""
    longest: dict[int, float] = {}
    for capsule in capsules:
        longest[capsule.link] = max(longest.get(capsule.link, 0.0), capsule.length_m)
    pairs = []
    for (i, one), (j, other) in combinations(enumerate(capsules), 2):
        low, high = sorted((one.link, other.link))
        length = sum(longest.get(link, 0.0) for link in range(low + 1, high))
        if high - low > 1 and length > one.radius_m + other.radius_m:
            pairs.append((i, j))
    return pairs


@dataclass(frozen=True, eq=False)
class Swept:
    """Points of the axes of an arm's capsules, at many instants.

    Attributes
    ----------
    points : (n, 3) array, m
        In some frame.
    radii_m : (n,) array, m
        Of the capsule that each is of.
    capsules, instants : (n,) arrays of int
        Numbers of that capsule, and of the instant.
    """

    points: Floats
    radii_m: Floats
    capsules: AnyArray
    instants: AnyArray


def swept(
    arm: Arm,
    angles_rad: Floats,
    here_from_base: Sequence[RigidTransform],
    links: Collection[int],
) -> Swept:
    """Return what an arm's capsules pass.

    Parameters
    ----------
    arm : Arm
    angles_rad : (m, n) array, rad
        The joints at each instant.
    here_from_base : sequence of m RigidTransform
        The base in the frame that is asked for, at each instant.
    links : collection of int
        Whose capsules count.
    """
    numbers = [k for k, capsule in enumerate(arm.capsules) if capsule.link in links]
    shares = {
        k: np.linspace(0.0, 1.0, 2 + int(arm.capsules[k].length_m / ALONG_M)) for k in numbers
    }
    points, which, when = [np.empty((0, 3))], [], []
    for instant, (angles, stands) in enumerate(zip(angles_rad, here_from_base, strict=True)):
        axes = axes_in_base(arm, angles)
        for k in numbers:
            start, end = stands @ axes[k]
            points.append(start + shares[k][:, None] * (end - start))
            which += [k] * len(shares[k])
            when += [instant] * len(shares[k])
    radii = np.array([capsule.radius_m for capsule in arm.capsules])
    chosen = np.array(which, dtype=np.int64)
    return Swept(np.concatenate(points), radii[chosen], chosen, np.array(when, dtype=np.int64))


@dataclass(frozen=True, eq=False)
class Surroundings:
    """A spacecraft's surface, for an arm to stay clear of.

    Attributes
    ----------
    name : str
    triangles : (t, 3, 3) array, m
        In the spacecraft's frame.
    """

    name: str
    triangles: Floats

    @classmethod
    def of(cls, craft: Spacecraft) -> Surroundings:
        """Return the surface of a spacecraft."""
        meshes = [np.asarray(p.mesh.vertices)[np.asarray(p.mesh.faces)] for p in craft.parts]
        return cls(craft.name, np.concatenate(meshes))

    def gaps(self, passed: Swept) -> Floats:
        """Return how far each point's capsule is from the surface, (n,), m; at most ``FAR_M``.

        Parameters
        ----------
        passed : Swept
            In the spacecraft's frame.
        """
        from scipy.spatial import KDTree

        if not len(passed.points):
            return np.empty(0)
        middles = self.triangles.mean(axis=1)
        sizes = np.linalg.norm(self.triangles - middles[:, None], axis=2).max(axis=1)
        within = FAR_M + float(passed.radii_m.max())
        reach = within + float(sizes.max())
        nearest, _ = KDTree(passed.points).query(middles, distance_upper_bound=reach)
        near = self.triangles[np.asarray(nearest) <= within + sizes]
        if not len(near):
            return np.full(len(passed.points), FAR_M)
        distances, _ = KDTree(sampled(near)).query(passed.points)
        return np.minimum(np.asarray(distances) - passed.radii_m, FAR_M)


def sampled(triangles: Floats) -> Floats:
    """Return points of triangles such that every place of them has one within ``SAMPLED_M``.

    Parameters
    ----------
    triangles : (t, 3, 3) array, m

    Returns
    -------
    (n, 3) array, m
    """
    edges = np.linalg.norm(np.roll(triangles, 1, axis=1) - triangles, axis=2).max(axis=1)
    cuts = np.maximum(1, np.ceil(edges / (SQRT_3 * SAMPLED_M))).astype(np.int64)
    points = []
    for n in np.unique(cuts):
        i, j = (each.ravel() for each in np.mgrid[: n + 1, : n + 1])
        corner = np.stack([i, j, n - i - j], axis=1)[i + j <= n] / n
        points.append(np.einsum("pc,tcx->tpx", corner, triangles[cuts == n]).reshape(-1, 3))
    return np.concatenate(points)


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray((a * b).sum(axis=-1))


def _ratio(over: Floats, under: Floats) -> Floats:
    """Return a ratio, zero where there is nothing to divide by."""
    safe = np.where(under > 0.0, under, 1.0)
    return np.where(under > 0.0, over / safe, 0.0)
