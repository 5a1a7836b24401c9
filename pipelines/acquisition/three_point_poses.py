"""Poses from three points, for thousands of landmark triples at once.

Three directions and three distances between landmarks give up to four poses: Grunert's quartic, in
the form of Haralick, Lee, Ottenberg and Nolle 1994, "Review and analysis of solutions of the three
point perspective pose estimation problem". The distances to the landmarks are then polished by
Newton's method on the law of cosines.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices

ALMOST_REAL = 1e-2  # noise turns a double root into a pair of complex ones: keep its real part
VANISHING = 1e-9
POLISHING_STEPS = 2
LARGEST_MISFIT = 0.02  # of a squared side over the largest one, after polishing
LEAST_ALTITUDE = 0.05  # of a triangle over its longest side: flatter ones determine no pose


@dataclass(frozen=True, eq=False)
class LandmarkTriples:
    """Ordered triples of landmarks with what a pose needs of them; made once for a target.

    Attributes
    ----------
    landmarks : (q, 3) int array
    squared_sides : (3, q) array, m^2
        Opposite to the first, second and third landmark.
    axes : (q, 3, 3) array
        Rows are a right-handed triad: first side, in the plane, normal.
    first_in_target : (q, 3) array, m
    row : (q,) int array
        Place of each among the triples offered.
    """

    landmarks: Indices
    squared_sides: Floats
    axes: Floats
    first_in_target: Floats
    row: Indices

    def __len__(self) -> int:
        return len(self.landmarks)

    @classmethod
    def among(cls, points_in_target: Floats, chosen: Indices) -> LandmarkTriples:
        """List all ordered triples of the chosen landmarks that are not nearly in a line.

        Parameters
        ----------
        points_in_target : (n, 3) array, m
        chosen : (k,) int array
            Which of them.
        """
        count = len(chosen)
        every = np.stack(np.meshgrid(*3 * [np.arange(count)], indexing="ij"), axis=-1)
        triples = every.reshape(-1, 3)
        i, j, k = triples.T
        return cls.of(points_in_target, chosen[triples[(i != j) & (j != k) & (i != k)]])

    @classmethod
    def of(cls, points_in_target: Floats, triples: Indices) -> LandmarkTriples:
        """Take triples (q, 3) but for those that are nearly in a line."""
        first, second, third = (points_in_target[triples[:, n]] for n in range(3))
        sides = np.stack([third - second, third - first, second - first])
        squared = (sides**2).sum(axis=-1)
        area = np.linalg.norm(np.cross(sides[2], sides[1]), axis=-1)
        keep = area > LEAST_ALTITUDE * squared.max(axis=0)
        return cls(
            triples[keep],
            squared[:, keep],
            _triads(sides[2, keep], sides[1, keep]),
            first[keep],
            np.flatnonzero(keep),
        )


def _triads(along: Floats, across: Floats) -> Floats:
    x = along / np.linalg.norm(along, axis=-1, keepdims=True)
    z = np.cross(along, across)
    z /= np.linalg.norm(z, axis=-1, keepdims=True)
    return np.stack([x, np.cross(z, x), z], axis=-2)


def real_quartic_roots(coefficients: Floats) -> Floats:
    """Return the real roots of many quartics by Ferrari's method.

    Parameters
    ----------
    coefficients : (5, q) array
        Of the fourth power first.

    Returns
    -------
    (4, q) array; NaN where a root is complex, but for the real part of a pair that is nearly real.
    """
    a3, a2, a1, a0 = coefficients[1:] / coefficients[0]
    shift = 0.25 * a3
    s2 = shift * shift
    p = a2 - 6.0 * s2
    q = a1 - 2.0 * a2 * shift + 8.0 * s2 * shift
    r = a0 - a1 * shift + a2 * s2 - 3.0 * s2 * s2
    z = np.maximum(_largest_cubic_root(2.0 * p, p * p - 4.0 * r, -q * q), 0.0)
    w = np.sqrt(z)
    roots = np.empty((4, coefficients.shape[1]))
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        # The resolvent makes both the same; the first loses its digits where z vanishes.
        alike = np.copysign(np.sqrt(0.25 * (p + z) ** 2 - r), q)
        parting = np.where(z > VANISHING * (np.abs(p) + np.sqrt(np.abs(r))), 0.5 * q / w, alike)
        for row, sign in ((0, 1.0), (2, -1.0)):
            # y^2 + sign w y + (p + z)/2 - sign q/(2 w) = 0
            quarter = 0.25 * z - 0.5 * (p + z) + sign * parting
            nearly = (quarter < 0.0) & (quarter > -ALMOST_REAL * (z + 1.0))
            half = np.sqrt(np.where(nearly, 0.0, quarter))
            roots[row] = -sign * 0.5 * w + half - shift
            roots[row + 1] = -sign * 0.5 * w - half - shift
    return roots


def _largest_cubic_root(b: Floats, c: Floats, d: Floats) -> Floats:
    """Return the largest real root of ``z^3 + b z^2 + c z + d``, element by element."""
    third = b / 3.0
    p = c - b * third
    q = 2.0 * third**3 - third * c + d
    half = 0.5 * q
    discriminant = half * half + (p / 3.0) ** 3
    one = np.sqrt(np.maximum(discriminant, 0.0))
    u = np.cbrt(-half - np.copysign(one, half))
    single = u - np.where(u != 0.0, p / (3.0 * np.where(u != 0.0, u, 1.0)), 0.0)
    radius = np.sqrt(np.maximum(-p / 3.0, 1e-30))
    cosine = np.clip(-half / radius**3, -1.0, 1.0)
    three = 2.0 * radius * np.cos(np.arccos(cosine) / 3.0)
    root = np.where(discriminant > 0.0, single, three) - third
    for _ in range(2):
        slope = c + root * (2.0 * b + 3.0 * root)
        value = d + root * (c + root * (b + root))
        root = root - np.where(slope != 0.0, value / np.where(slope != 0.0, slope, 1.0), 0.0)
    return np.asarray(root)


def _grunert(squared_sides: Floats, cosines: Floats) -> Floats:
    """Return the quartic in the third distance over the first, (5, q)."""
    a, b, c = squared_sides
    ca, cb, cg = cosines
    minus, plus, ab, cob = (a - c) / b, (a + c) / b, a / b, c / b
    return np.stack(
        [
            (minus - 1.0) ** 2 - 4.0 * cob * ca * ca,
            4.0 * (minus * (1.0 - minus) * cb - (1.0 - plus) * ca * cg + 2.0 * cob * ca * ca * cb),
            2.0
            * (
                minus * minus
                - 1.0
                + 2.0 * minus * minus * cb * cb
                + 2.0 * (1.0 - cob) * ca * ca
                - 4.0 * plus * ca * cb * cg
                + 2.0 * (1.0 - ab) * cg * cg
            ),
            4.0 * (2.0 * ab * cg * cg * cb - minus * (1.0 + minus) * cb - (1.0 - plus) * ca * cg),
            (1.0 + minus) ** 2 - 4.0 * ab * cg * cg,
        ]
    )


def _law_of_cosines(distances: Floats, squared_sides: Floats, cosines: Floats) -> Floats:
    """Return by how much distances (3, q) miss the squared sides, (3, q) m^2."""
    s1, s2, s3 = distances
    ca, cb, cg = cosines
    return np.stack(
        [
            s2 * s2 + s3 * s3 - 2.0 * s2 * s3 * ca - squared_sides[0],
            s1 * s1 + s3 * s3 - 2.0 * s1 * s3 * cb - squared_sides[1],
            s1 * s1 + s2 * s2 - 2.0 * s1 * s2 * cg - squared_sides[2],
        ]
    )


def _polished(distances: Floats, squared_sides: Floats, cosines: Floats) -> Floats:
    """Improve distances (3, q) until the law of cosines gives the sides."""
    ca, cb, cg = cosines
    for _ in range(POLISHING_STEPS):
        s1, s2, s3 = distances
        f1, f2, f3 = _law_of_cosines(distances, squared_sides, cosines)
        # Half the Jacobian: rows (0, a2, a3), (b1, 0, b3), (c1, c2, 0).
        a2, a3 = s2 - s3 * ca, s3 - s2 * ca
        b1, b3 = s1 - s3 * cb, s3 - s1 * cb
        c1, c2 = s1 - s2 * cg, s2 - s1 * cg
        determinant = 2.0 * (a2 * b3 * c1 + a3 * b1 * c2)
        step = np.stack(
            [
                -b3 * c2 * f1 + a3 * c2 * f2 + a2 * b3 * f3,
                b3 * c1 * f1 - a3 * c1 * f2 + a3 * b1 * f3,
                b1 * c2 * f1 + a2 * c1 * f2 - a2 * b1 * f3,
            ]
        )
        step /= np.where(np.abs(determinant) > 1e-12, determinant, np.inf)
        limit = 0.1 * s1  # a double root has no slope
        distances = distances - np.clip(step, -limit, limit)
    return distances


def three_point_poses(rays: Floats, triples: LandmarkTriples) -> tuple[Floats, Floats, Indices]:
    """Return every pose that brings a triple of landmarks onto three rays.

    Parameters
    ----------
    rays : (3, 3) or (q, 3, 3) array
        Unit directions in the camera's axes, one in a row: for all triples, or three for each.
    triples : LandmarkTriples

    Returns
    -------
    rotations : (p, 3, 3) array
    translations : (p, 3) array, m
        ``cam_from_target``.
    of_triple : (p,) int array
        Row of ``triples`` that gave the pose.
    """
    each = np.broadcast_to(rays, (len(triples), 3, 3))
    other = rays[..., [1, 0, 0], :] * rays[..., [2, 2, 1], :]
    cosines = np.broadcast_to(other.sum(axis=-1), (len(triples), 3)).T
    ca, cb, cg = cosines
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        v = real_quartic_roots(_grunert(triples.squared_sides, cosines))
        a, b, c = triples.squared_sides
        minus = (a - c) / b
        u = ((minus - 1.0) * v * v - 2.0 * minus * cb * v + 1.0 + minus) / (2.0 * (cg - v * ca))
        s1 = np.sqrt(b / (1.0 + v * v - 2.0 * v * cb))
        distances = np.stack([s1, u * s1, v * s1])
    good = np.isfinite(distances).all(axis=0) & (distances > 0.0).all(axis=0)
    _, of_triple = np.nonzero(good)
    sides = triples.squared_sides[:, of_triple]
    angles = cosines[:, of_triple]
    found = _polished(distances[:, good], sides, angles)
    misfit = np.abs(_law_of_cosines(found, sides, angles)).max(axis=0)
    kept = (misfit < LARGEST_MISFIT * sides.max(axis=0)) & (found > 0.0).all(axis=0)
    found, of_triple = found[:, kept], of_triple[kept]
    in_cam = found.T[:, :, None] * each[of_triple]
    axes = _triads(in_cam[:, 1] - in_cam[:, 0], in_cam[:, 2] - in_cam[:, 0])
    rotations = axes.transpose(0, 2, 1) @ triples.axes[of_triple]
    turned = np.einsum("pij,pj->pi", rotations, triples.first_in_target[of_triple])
    return rotations, in_cam[:, 0] - turned, of_triple
