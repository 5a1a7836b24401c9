"""Where an edge of known form lies, section by section, from the pixels of a narrow band along it.

Each section has its own brightness on either side, so light that changes along the edge, and
shadows, are no model error; only where a shadow's border crosses a section does it misfit. Within
a section the level is ``B + H E(d + e)`` with E the edge of ``detection.pixel_edge``, d how far
inside the predicted edge a pixel lies and e how far outside of it the edge was found. The blur of
the lens is common to all sections.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices
from pipelines.detection.pixel_edge import edge_signal

MOST_ITERATIONS, SETTLED_PX = 12, 1e-3  # a sharp edge, told to be soft, takes some eight
FAR_INSIDE_PX = 2.5  # beyond it a pixel knows little of the edge's place
BLUR_RANGE_PX = (0.2, 6.0)
BLUR_TOLERANCE = 0.5  # 1-sigma of the blur told, relative
LEAST_VARIANCE = 1e-6


@dataclass(frozen=True, eq=False)
class EdgeBand:
    """The pixels near an edge.

    Attributes
    ----------
    section : (m,) int array
        To which of the edge's sections each belongs, from 0.
    depth_px : (m,) array, px
        How far inside the predicted edge, negative outside.
    normals : (m, 2) array
        The edge's unit normal there, outward.
    level : (m,) array, DN
        Above the bias.
    gain : (m,) array
        By what the pixel's own charge was multiplied to give the level.
    sections : int
        How many there are.
    """

    section: Indices
    depth_px: Floats
    normals: Floats
    level: Floats
    gain: Floats
    sections: int


@dataclass(frozen=True, eq=False)
class FoundEdge:
    """What was found of an edge, (n,) arrays, one number a section.

    Attributes
    ----------
    offset_px, sigma_px : (n,) arrays, px
        How far outside the predicted edge, and its 1-sigma from the pixels' noise; infinite sigma
        where there is no telling.
    step, step_sigma : (n,) arrays, DN
        Level inside minus level outside.
    misfit : (n,) array
        Root mean square of what neither edge nor noise explains, over the step.
    blur_px : float, px
    """

    offset_px: Floats
    sigma_px: Floats
    step: Floats
    step_sigma: Floats
    misfit: Floats
    blur_px: float


def find_edge(
    band: EdgeBand,
    width_px: float,
    radius_px: float,
    blur_px: float,
    noise: tuple[float, float, float],
) -> FoundEdge:
    """Find an edge.

    Parameters
    ----------
    band : EdgeBand
    width_px : float, px
        Half the band's width: all pixels lie within it.
    radius_px : float, px
        Of the edge's curvature.
    blur_px : float, px
        1-sigma of the lens's blur, as expected.
    noise : tuple of 3 floats
        Variance of a level is ``a + b level + (c level)^2``: of reading, of charge, of response.
    """
    count, place = band.sections, band.section
    outside, step, offset = _start(band, width_px)
    blur = float(np.clip(blur_px, *BLUR_RANGE_PX))
    normal_x, normal_y = band.normals[:, 0], band.normals[:, 1]
    pixels = np.bincount(place, minlength=count).astype(np.float64)
    covariance = np.zeros((count, 3, 3))
    residual = weight = np.zeros_like(band.level)
    for turn in range(MOST_ITERATIONS):
        edge = edge_signal(band.depth_px + offset[place], normal_x, normal_y, radius_px, blur)
        model = outside[place] + step[place] * edge.value
        residual = band.level - model
        weight = 1.0 / _variance(np.maximum(model, 0.0), band.gain, noise)
        by_offset, by_blur = step[place] * edge.by_depth, step[place] * edge.by_blur
        columns = (np.ones_like(residual), edge.value, by_offset)
        normal, right = _normal_equations(columns, residual, weight, place, count)
        inverse = _inverted(normal)
        covariance = inverse
        change = np.einsum("nij,nj->ni", inverse, right)
        blur_change, coupling = _blur_step(
            columns, by_blur, residual, weight, place, count, inverse, change, blur, blur_px
        )
        change = change - blur_change * np.einsum("nij,nj->ni", inverse, coupling)
        moved = np.clip(offset + np.clip(change[:, 2], -1.5, 1.5), -width_px, width_px)
        blurred = float(np.clip(blur + np.clip(blur_change, -0.5, 0.5), *BLUR_RANGE_PX))
        settled = max(np.abs(moved - offset).max(initial=0.0), abs(blurred - blur)) < SETTLED_PX
        if settled or turn == MOST_ITERATIONS - 1:
            break
        outside, step = outside + change[:, 0], step + change[:, 1]
        offset, blur = moved, blurred
    freedom = np.maximum(pixels - 3.0, 1.0)
    chi2 = np.bincount(place, weight * residual**2, minlength=count) / freedom
    square = np.bincount(place, residual**2, minlength=count) / freedom
    unexplained = square * np.maximum(1.0 - 1.0 / np.maximum(chi2, 1e-9), 0.0)
    variance = covariance[:, 2, 2] * np.maximum(chi2, 1.0)
    good = (pixels >= 8.0) & (variance > 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        misfit = np.sqrt(unexplained) / np.abs(step)
    return FoundEdge(
        offset_px=offset,
        sigma_px=np.where(good, np.sqrt(np.maximum(variance, 0.0)), np.inf),
        step=step,
        step_sigma=np.sqrt(np.maximum(covariance[:, 1, 1], 0.0)),
        misfit=np.where(good, misfit, np.inf),
        blur_px=blur,
    )


def _start(band: EdgeBand, width_px: float) -> tuple[Floats, Floats, Floats]:
    """Return both levels, and where the edge is by the share of the band that is inside."""
    count, place, depth = band.sections, band.section, band.depth_px
    rim = min(FAR_INSIDE_PX, 0.6 * width_px)

    def mean(chosen: Floats) -> Floats:
        held = np.bincount(place, chosen, minlength=count)
        total = np.bincount(place, chosen * band.level, minlength=count)
        return np.asarray(total / np.maximum(held, 1.0))

    outside = mean((depth < -rim).astype(np.float64))
    step = mean((depth > rim).astype(np.float64)) - outside
    share = (mean(np.ones_like(depth)) - outside) / np.where(np.abs(step) > 1e-6, step, 1e-6)
    reach = width_px - 1.0
    return outside, step, np.clip((2.0 * share - 1.0) * width_px, -reach, reach)


def _variance(level: Floats, gain: Floats, noise: tuple[float, float, float]) -> Floats:
    reading, charge, response = noise
    spread = reading * gain**2 + charge * gain * level + (response * level) ** 2
    return np.maximum(spread, LEAST_VARIANCE)


def _normal_equations(
    columns: tuple[Floats, ...], residual: Floats, weight: Floats, place: Indices, count: int
) -> tuple[Floats, Floats]:
    normal, right = np.empty((count, 3, 3)), np.empty((count, 3))
    for i, first in enumerate(columns):
        weighted = weight * first
        right[:, i] = np.bincount(place, weighted * residual, minlength=count)
        for j in range(i, 3):
            normal[:, i, j] = np.bincount(place, weighted * columns[j], minlength=count)
            normal[:, j, i] = normal[:, i, j]
    return normal, right


def _inverted(normal: Floats) -> Floats:
    """Invert each section's equations; one that determines nothing gets zeros."""
    scale = np.sqrt(np.maximum(np.einsum("nii->ni", normal), 1e-12))
    balanced = normal / (scale[:, :, None] * scale[:, None, :])
    sound = np.linalg.det(balanced) > 1e-7
    balanced[~sound] = np.eye(3)
    inverse = np.linalg.inv(balanced) / (scale[:, :, None] * scale[:, None, :])
    inverse[~sound] = 0.0
    return np.asarray(inverse)


def _blur_step(
    columns: tuple[Floats, ...],
    by_blur: Floats,
    residual: Floats,
    weight: Floats,
    place: Indices,
    count: int,
    inverse: Floats,
    change: Floats,
    blur: float,
    told_blur: float,
) -> tuple[float, Floats]:
    """Solve for the common blur, all else eliminated; and how each section's unknowns feel it."""
    weighted = weight * by_blur
    coupling = np.stack(
        [np.bincount(place, weighted * column, minlength=count) for column in columns], axis=1
    )
    own = float((weighted * by_blur).sum())
    own -= float(np.einsum("ni,nij,nj->", coupling, inverse, coupling))
    pull = float((weighted * residual).sum()) - float((coupling * change).sum())
    prior = (BLUR_TOLERANCE * max(told_blur, BLUR_RANGE_PX[0])) ** -2.0
    change_px = (pull + prior * (told_blur - blur)) / max(own + prior, 1e-12)
    return float(change_px), np.asarray(coupling, dtype=np.float64)
