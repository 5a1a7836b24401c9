"""A straight edge with a strip before it: black, then the board's own shadow, then what is bright.

Whoever looks for the largest step finds the shadow's border, and takes the board for larger than
it is. All sections of an edge are fitted together: with ``F`` the edge of ``detection.pixel_edge``
the level is ``I F(x) + S (F(x + s) - F(x)) + O (1 - F(x + s))``, x inside the edge, s the strip's
width, I and S the levels of board and strip, O that outside, of each section its own. Levels are
eliminated (Golub and Pereyra 1973); what is left are the edge's place, its turn, and s.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices
from pipelines.detection.pixel_edge import edge_signal

OUTSIDE_PX = 1.5  # beyond the largest step that is looked at: further out is what lies there
UNEVEN = 0.1  # 1-sigma of what lies outside, over its level above the board's
BIN_PX = 0.5
CLEAR_PX, CLEAR_SIGMAS, CLEAR_SHARE = 1.0, 6.0, 0.1
NARROW_PX = 0.8  # from where a strip is looked for that no bin shows
TURNS = 12
STEPS = (1e-3, 1e-3, 1e-3)
SETTLED_PX = 1e-3
LEAST_GAIN = 25.0  # in chi-square, of a strip over none
MOST_LEVEL = 0.7  # of a strip, over the board's: it lies in shadow, the board in light
STRAIGHT_PX = 1e6
LEAST_PIXELS_OVER = 10


@dataclass(frozen=True, eq=False)
class EdgePixels:
    """The pixels along an edge, m of them.

    Attributes
    ----------
    inside_px : (m,) array, px
        How far inside the largest step.
    along : (m,) array
        Where along the edge, -1 to 1.
    section : (m,) int array
        Of n, from 0, each with a level outside of its own.
    normal : (2,) array
        Of the edge, outward.
    level : (m,) array, DN
        Above the bias.
    """

    inside_px: Floats
    along: Floats
    section: Indices
    normal: Floats
    level: Floats


@dataclass(frozen=True, eq=False)
class Strip:
    """A strip that was found.

    Attributes
    ----------
    offset_px, turn_px : float, px
        How far outside the largest step the board ends, negative; and how much more at the end.
    width_px : float, px
    covariance_px2 : (2, 2) array, px^2
        Of the first two.
    """

    offset_px: float
    turn_px: float
    width_px: float
    covariance_px2: Floats


def find_strip(
    pixels: EdgePixels, blur_px: float, noise: tuple[float, float, float]
) -> Strip | None:
    """Look for a strip between an edge and the largest step; None where there is none.

    Parameters
    ----------
    pixels : EdgePixels
    blur_px : float, px
    noise : tuple of 3 floats
        Variance of a level is ``a + b level + (c level)^2``.
    """
    near = pixels.inside_px > -OUTSIDE_PX
    pixels = EdgePixels(
        pixels.inside_px[near],
        pixels.along[near],
        np.unique(pixels.section[near], return_inverse=True)[1],
        pixels.normal,
        pixels.level[near],
    )
    unknowns = int(pixels.section.max(initial=-1)) + 7
    if len(pixels.level) < unknowns + LEAST_PIXELS_OVER:
        return None
    reach = float(pixels.inside_px.max())
    fit = _Fit(pixels, blur_px, noise)
    none = fit.of(np.zeros(3))
    best: _Fitted | None = None
    for width in {NARROW_PX, _shown_width(pixels)}:
        fitted = fit.of(np.array([-width, 0.0, width]))
        if best is None or fitted.chi2 < best.chi2:
            best = fitted
    assert best is not None
    freedom = max(len(pixels.level) - unknowns, 1)
    scale = max(best.chi2 / freedom, 1.0)
    offset, turn, width = best.place
    sound = best.sound and 0.0 < width < reach and -reach < offset < BIN_PX
    sound = sound and best.strip < MOST_LEVEL * best.board
    if not sound or (none.chi2 - best.chi2) / scale < LEAST_GAIN:
        return None
    return Strip(float(offset), float(turn), float(width), scale * best.covariance[:2, :2])


def _shown_width(pixels: EdgePixels) -> float:
    """Return how far inside the largest step the level is another than the board's own."""
    reach = float(pixels.inside_px.max())
    board = pixels.level[pixels.inside_px > 0.5 * reach]
    if len(board) == 0:
        return NARROW_PX
    own = float(np.median(board))
    spread = 1.4826 * float(np.median(np.abs(board - own)))
    width, extreme = NARROW_PX, 0.0
    for low in np.arange(CLEAR_PX, reach, BIN_PX):
        held = pixels.level[(pixels.inside_px >= low) & (pixels.inside_px < low + BIN_PX)]
        if len(held) == 0:
            continue
        away = abs(float(np.median(held)) - own)
        limit = max(CLEAR_SIGMAS * spread / np.sqrt(len(held)), CLEAR_SHARE * abs(own))
        if away > max(limit, 0.5 * extreme):
            extreme, width = max(extreme, away), float(low + BIN_PX)
    return width


@dataclass(frozen=True, eq=False)
class _Fitted:
    place: Floats
    chi2: float
    covariance: Floats
    sound: bool
    board: float
    strip: float


class _Fit:
    def __init__(self, pixels: EdgePixels, blur_px: float, noise: tuple[float, float, float]):
        self._pixels, self._blur_px, self._noise = pixels, blur_px, noise
        outside = np.zeros((len(pixels.level), int(pixels.section.max()) + 1))
        outside[np.arange(len(pixels.level)), pixels.section] = 1.0
        self._outside = outside
        deep = pixels.inside_px > 0.5 * float(pixels.inside_px.max())
        board = float(np.median(pixels.level[deep])) if deep.any() else 0.0
        reading, charge, response = noise
        level = np.maximum(pixels.level, 0.0)
        uneven = UNEVEN * np.maximum(level - max(board, 0.0), 0.0)
        self._sigma = np.sqrt(reading + charge * level + (response * level) ** 2 + uneven**2)

    def of(self, start: Floats) -> _Fitted:
        """Fit from a start; one without a width keeps none."""
        free = 3 if start[2] > 0.0 else 2
        place, sound = start.copy(), True
        residual, levels = self._residual(place)
        chi2, damping = float(residual @ residual), 1e-3
        normal = np.eye(free)
        for _ in range(TURNS):
            slope = np.column_stack(
                [
                    (self._residual(place + step * np.eye(3)[index])[0] - residual) / step
                    for index, step in enumerate(STEPS[:free])
                ]
            )
            normal, right = slope.T @ slope, slope.T @ residual
            damped = normal + damping * np.diag(np.maximum(np.diag(normal), 1e-9))
            step = np.clip(-np.linalg.solve(damped, right), -1.0, 1.0)
            tried = place.copy()
            tried[:free] += step
            tried[2] = max(tried[2], 0.0)
            left, new = self._residual(tried)
            if float(left @ left) < chi2:
                place, residual, levels, chi2 = tried, left, new, float(left @ left)
                damping = max(0.1 * damping, 1e-9)
                if np.abs(step).max() < SETTLED_PX:
                    break
            elif damping > 1e6:
                break
            else:
                damping *= 10.0
        scale = np.sqrt(np.maximum(np.diag(normal), 1e-12))
        balanced = normal / np.outer(scale, scale)
        sound = bool(np.linalg.cond(balanced) < 1e8)
        inverse = np.linalg.inv(balanced) / np.outer(scale, scale) if sound else np.eye(free)
        return _Fitted(place, chi2, inverse, sound, float(levels[0]), float(levels[2]))

    def _residual(self, place: Floats) -> tuple[Floats, Floats]:
        """Return what is left of the levels, over their sigmas, and the levels that fit."""
        own = self._pixels
        depth = own.inside_px + place[0] + place[1] * own.along
        board = edge_signal(depth, own.normal[0], own.normal[1], STRAIGHT_PX, self._blur_px).value
        if place[2] > 0.0:
            whole = edge_signal(
                depth + place[2], own.normal[0], own.normal[1], STRAIGHT_PX, self._blur_px
            ).value
            inner = [board, board * own.along, whole - board]
        else:
            whole, inner = board, [board, board * own.along]
        columns = np.column_stack([*inner, self._outside * (1.0 - whole)[:, None]])
        weighted = columns / self._sigma[:, None]
        told = own.level / self._sigma
        gram = weighted.T @ weighted
        gram[np.diag_indices_from(gram)] += 1e-9 * np.trace(gram) / len(gram)
        levels: Floats = np.linalg.solve(gram, weighted.T @ told).astype(np.float64)
        return np.asarray(told - weighted @ levels), levels
