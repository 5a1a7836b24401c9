"""Bright blobs on black that may be painted discs, whole or in part: each with its circle.

A blob that a shadow cuts has its centroid in the wrong place, but what is left of its rim still
lies on a circle of known radius. Circles through pairs of boundary pixels vote (Fischler and Bolles
1981); the one that most of the boundary lies on wins.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from models.arrays import Floats, Mask, Radiance

MOST_BLOBS = 60
PAIRS = 60
LEAST_AREA, MOST_AREA = 0.15, 1.5  # over the disc's
RADIUS_SLACK = 0.06
ON_CIRCLE_PX, ON_CIRCLE_SHARE = 0.7, 0.04
BINS = 24
LEAST_ARC = 0.3
SURROUND = (1.3, 1.6)  # radii
MOST_SURROUND = 0.5  # of the blob's own level: a dot stands on black
SAME_PLACE = 0.3  # of a radius
INSIDE_PX = 0.4  # a boundary pixel's centre lies so far inside the edge, in the mean


@dataclass(frozen=True, eq=False)
class DotCandidates:
    """Circles that may be dots, n of them.

    Attributes
    ----------
    centres : (n, 2) array, px
    radii : (n,) array, px
    arcs : (n,) array
        Share of each circle that the blob's boundary covers.
    """

    centres: Floats
    radii: Floats
    arcs: Floats

    def __len__(self) -> int:
        return len(self.centres)

    def joined(self, other: DotCandidates) -> DotCandidates:
        """Return these and others; of two circles about one place that of the larger arc.

        Parameters
        ----------
        other : DotCandidates
        """
        if len(self) == 0 or len(other) == 0:
            return self if len(other) == 0 else other
        centres = np.concatenate([self.centres, other.centres])
        radii = np.concatenate([self.radii, other.radii])
        arcs = np.concatenate([self.arcs, other.arcs])
        kept: list[int] = []
        for index in np.argsort(-arcs, kind="stable").tolist():
            gaps = np.linalg.norm(centres[kept] - centres[index], axis=1)
            if not (gaps < SAME_PLACE * radii[index]).any():
                kept.append(index)
        return DotCandidates(centres[kept], radii[kept], arcs[kept])

    @classmethod
    def none(cls) -> DotCandidates:
        """Return no candidates."""
        return cls(np.zeros((0, 2)), np.zeros(0), np.zeros(0))


def find_dots(
    grey: Radiance,
    foreground: Mask,
    radii: tuple[float, float],
    expected: Floats,
    reach: float,
) -> DotCandidates:
    """Find circles among the blobs of a foreground.

    Parameters
    ----------
    grey : (height, width) array
    foreground : (height, width) array of bool
    radii : tuple of 2 floats, px
        Smallest and largest that any dot may have.
    expected : (n, 2) array, px
        Where dots are expected; NaN for one that is not.
    reach : float, px
        How far from there a dot may lie.
    """
    count, label, stats, _ = cv2.connectedComponentsWithStats(foreground.astype(np.uint8))
    area = stats[:, cv2.CC_STAT_AREA]
    least, most = LEAST_AREA * np.pi * radii[0] ** 2, MOST_AREA * np.pi * radii[1] ** 2
    sides = stats[:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]]
    fits = (area >= max(least, 6.0)) & (area <= most) & (sides <= 2.6 * radii[1] + 2.0).all(axis=1)
    corners = stats[:, [cv2.CC_STAT_LEFT, cv2.CC_STAT_TOP]]
    gaps = np.linalg.norm((corners + 0.5 * sides)[:, None] - expected[None], axis=-1)
    fits &= np.nan_to_num(gaps, nan=np.inf).min(axis=1) < reach + radii[1]
    chosen = [number for number in range(1, count) if fits[number]]
    chosen.sort(key=lambda number: -int(area[number]))
    found = []
    for number in chosen[:MOST_BLOBS]:
        left, top, width, height = stats[number, :4]
        part = label[top : top + height, left : left + width] == number
        circle = _circle(part, radii)
        if circle is None:
            continue
        centre, radius, arc = circle
        centre = centre + np.array([left, top])
        if arc >= LEAST_ARC and _stands_on_black(grey, part, (left, top), centre, radius):
            found.append((centre, radius, arc))
    if not found:
        return DotCandidates.none()
    centres, circles, arcs = zip(*found, strict=True)
    return DotCandidates(np.array(centres), np.array(circles), np.array(arcs))


def _circle(part: Mask, radii: tuple[float, float]) -> tuple[Floats, float, float] | None:
    """Return centre, radius and covered share of the circle that fits a blob's boundary best."""
    contours, _ = cv2.findContours(
        np.pad(part.astype(np.uint8), 1), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE
    )
    points = max(contours, key=len)[:, 0].astype(np.float64) - 1.0
    if len(points) < 6:
        return None
    radius = 0.5 * (radii[0] + radii[1]) - INSIDE_PX
    limit = ON_CIRCLE_PX + ON_CIRCLE_SHARE * radius + 0.5 * (radii[1] - radii[0])
    centres = _through_pairs(points, radius)
    if len(centres) == 0:
        return None
    away = np.linalg.norm(points[None] - centres[:, None], axis=-1)
    votes = (np.abs(away - radius) < limit).sum(axis=1)
    centre = centres[int(np.argmax(votes))]
    low, high = radii[0] * (1.0 - RADIUS_SLACK), radii[1] * (1.0 + RADIUS_SLACK)
    for _ in range(4):
        rays = points - centre
        gaps = np.linalg.norm(rays, axis=1)
        near = np.abs(gaps - radius) < limit
        if near.sum() < 5:
            return None
        ways = rays[near] / np.maximum(gaps[near], 1e-9)[:, None]
        design = np.column_stack([ways, np.ones(len(ways))])
        normal = design.T @ design
        normal[2, 2] += len(ways) * 0.5  # the radius is nearly known
        step = np.linalg.solve(normal, design.T @ (gaps[near] - radius))
        centre = centre + step[:2]
        radius = float(np.clip(radius + step[2], low - INSIDE_PX, high))
    rays = points - centre
    near = np.abs(np.linalg.norm(rays, axis=1) - radius) < limit
    turn = np.arctan2(rays[near, 1], rays[near, 0]) % (2.0 * np.pi)
    bins = min(BINS, max(8, int(2.0 * np.pi * radius / 2.0)))
    covered = np.unique((turn * (bins / (2.0 * np.pi))).astype(int) % bins)
    return centre, radius + INSIDE_PX, len(covered) / bins


def _through_pairs(points: Floats, radius: float) -> Floats:
    """Return the centres of circles of a radius through pairs of boundary points, (k, 2)."""
    count = len(points)
    first = np.linspace(0, count, PAIRS, endpoint=False).astype(int)
    centres = []
    for apart in (count // 6, count // 4, count // 3):
        one, other = points[first], points[(first + max(apart, 1)) % count]
        chord = other - one
        half = 0.5 * np.linalg.norm(chord, axis=1)
        able = (half > 0.3) & (half < radius)
        height = np.sqrt(radius**2 - half[able] ** 2)
        across = np.stack([-chord[able, 1], chord[able, 0]], axis=1) / (2.0 * half[able])[:, None]
        middle = 0.5 * (one[able] + other[able])
        centres += [middle + height[:, None] * across, middle - height[:, None] * across]
    return np.concatenate(centres)


def _stands_on_black(
    grey: Radiance, part: Mask, corner: tuple[int, int], centre: Floats, radius: float
) -> bool:
    low = np.maximum(np.floor(centre - SURROUND[1] * radius - 1.0), 0).astype(int)
    high = np.ceil(centre + SURROUND[1] * radius + 2.0).astype(int)
    window = grey[low[1] : high[1], low[0] : high[0]]
    v, u = np.indices(window.shape)
    away = np.hypot(u + low[0] - centre[0], v + low[1] - centre[1]) / radius
    ring = window[(away > SURROUND[0]) & (away < SURROUND[1])]
    left, top = corner
    own = grey[top : top + part.shape[0], left : left + part.shape[1]][part]
    return len(ring) > 0 and float(np.median(ring)) < MOST_SURROUND * float(np.median(own))
