"""The centre of a painted disc by its rim, of which a shadow may leave only a part.

The disc's outline is known from a pose; its rim is measured in sections (``detection.edge_band``)
in the raw pixels of a Bayer chip, each colour scaled so that the disc is white: nothing is
interpolated. Sections that a shadow's border crosses misfit or lie off the others and are left out;
what is left fixes the centre, with the covariance that so much of a rim gives, or is refused.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Image, Indices, Mask
from models.sensors.bayer_mosaic import RGGB
from models.sensors.camera_chip import Detector
from pipelines.detection.edge_band import EdgeBand, FoundEdge, find_edge

SECTION_PX = 8.0  # along the rim
SECTIONS = (8, 16, 48)  # at least; of radii that are not small; at most
BAND_PX, BAND_SHARE = 3.5, 0.45  # half-width: so much and what the blur takes, at most of a radius
BLURS = 1.5
LEAST_STEP_SIGMAS = 8.0
MOST_MISFIT = 0.06  # of a section, over its step
SMALL_PX = 12.0  # radius below which sections are fewer, and misfit more: pixels are no points
OUTLIER_SIGMAS, LEAST_SPREAD_PX = 4.0, 0.02
SECTION_FLOOR_PX = 0.004  # 1-sigma of a section's place from taking its edge and light as even
CENTRE_FLOOR_PX, CENTRE_FLOOR_SHARE = 0.003, 7e-4  # and of the radius: light is not quite even
LEAST_RIM = 0.35  # of the rim: with less, a wrong radius moves the centre too far
ROUNDS = 8


@dataclass(frozen=True)
class KnownDisc:
    """How well a disc is known before it is fitted.

    Attributes
    ----------
    size_sigma : float
        1-sigma of the predicted radius, relative.
    shape_sigma : float
        1-sigma of each section's distance from the centre, for another tilt, over the radius.
    capture_px : float, px
        How far off the predicted rim it is looked for, beyond what its blur takes.
    """

    size_sigma: float
    shape_sigma: float = 0.0
    capture_px: float = 0.0


@dataclass(frozen=True, eq=False)
class LitDisc:
    """A disc that was found.

    Attributes
    ----------
    shift_px : (2,) array, px
        Of its centre from where the pose has it.
    covariance_px2 : (2, 2) array, px^2
    size : float
        Its radius over the predicted one.
    rim : float
        Share of the rim that was used.
    misfit_chi2 : float
        Reduced chi-square of the sections' places about the disc.
    blur_px : float, px
    level_dn : float, DN
        Of the disc above its surround.
    """

    shift_px: Floats
    covariance_px2: Floats
    size: float
    rim: float
    misfit_chi2: float
    blur_px: float
    level_dn: float


def noise_terms(detector: Detector) -> tuple[float, float, float]:
    """Return a, b, c of a level's variance ``a + b level + (c level)^2``, DN^2, DN and 1."""
    reading = (detector.read_noise_e / detector.gain_e_dn) ** 2 + 1.0 / 12.0
    return reading, 1.0 / detector.gain_e_dn, detector.prnu


def fit_lit_disc(
    raw: Image,
    detector: Detector,
    saturation_dn: float,
    centre_px: Floats,
    shape_px2: Floats,
    blur_px: float,
    known: KnownDisc,
) -> LitDisc | str:
    """Fit one disc.

    Parameters
    ----------
    raw : (height, width) uint16 array, DN
    detector : Detector
    saturation_dn : float, DN
        Pixels at or above it are left out.
    centre_px : (2,) array, px
        Predicted centre of the outline's area; the shift is from here.
    shape_px2 : (2, 2) array, px^2
        Predicted ellipse, ``d^T S^-1 d = 1``.
    blur_px : float, px
        Expected 1-sigma of the lens's blur.
    known : KnownDisc

    Returns
    -------
    LitDisc or str
        In words, why there is none.
    """
    radius = float(np.linalg.det(shape_px2) ** 0.25)
    width = min(BAND_PX + BLURS * blur_px + known.capture_px, BAND_SHARE * radius + 1.0)
    taken = _band(raw, detector, saturation_dn, centre_px, shape_px2, radius, width)
    if isinstance(taken, str):
        return taken
    found = find_edge(taken, width, radius, blur_px, noise_terms(detector))
    angle = 2.0 * np.pi * (np.arange(taken.sections) + 0.5) / taken.sections
    ways = _ways(shape_px2, angle)
    return _centre(found, ways, known, radius, width)


@dataclass(frozen=True, eq=False)
class _Ways:
    """Outward normals of the sections, and how far each moves as the disc grows by one."""

    normals: Floats
    growth_px: Floats


def _ways(shape_px2: Floats, angle: Floats) -> _Ways:
    root = np.linalg.cholesky(shape_px2)
    away = np.stack([np.cos(angle), np.sin(angle)], axis=1) @ root.T
    gradient = away @ np.linalg.inv(shape_px2)
    normals = gradient / np.linalg.norm(gradient, axis=1, keepdims=True)
    return _Ways(normals, np.asarray((away * normals).sum(axis=1)))


def _band(
    raw: Image,
    detector: Detector,
    saturation_dn: float,
    centre_px: Floats,
    shape_px2: Floats,
    radius: float,
    width: float,
) -> EdgeBand | str:
    """Cut out the pixels along the rim, white-balanced by the disc's own face."""
    reach = np.sqrt(np.diag(shape_px2)) + width + 1.0
    size = np.array([raw.shape[1], raw.shape[0]])
    low = np.maximum(np.ceil(centre_px - reach), 0.0).astype(int)
    high = np.minimum(np.floor(centre_px + reach) + 1, size).astype(int)
    if (high - low < 4).any():
        return "it lies outside the image"
    x = np.arange(low[0], high[0])[None, :] - centre_px[0]
    y = np.arange(low[1], high[1])[:, None] - centre_px[1]
    inverse = np.linalg.inv(shape_px2)
    gradient_x, gradient_y = (
        inverse[0, 0] * x + inverse[0, 1] * y,
        inverse[1, 0] * x + inverse[1, 1] * y,
    )
    ellipse = np.sqrt(np.maximum(gradient_x * x + gradient_y * y, 1e-12))
    steepness = np.hypot(gradient_x, gradient_y)
    depth = (1.0 - ellipse) * ellipse / np.maximum(steepness, 1e-12)
    level = raw[low[1] : high[1], low[0] : high[0]].astype(np.float64)
    usable = level < saturation_dn
    level -= detector.bias_dn
    gain = _balance(level, usable & (depth > min(2.0, 0.3 * radius)), low, detector)
    if gain is None:
        return "its face is dark or saturated"
    chosen = usable & (np.abs(depth) <= width)
    row, column = np.nonzero(chosen)
    near = depth[row, column]
    normals = np.stack([gradient_x[row, column], gradient_y[row, column]], axis=1)
    normals /= steepness[row, column][:, None]
    gains = gain[row, column]
    count = _section_count(radius)
    section = _sections(shape_px2, x[0, column], y[row, 0], count)
    return EdgeBand(section, near, normals, level[row, column] * gains, gains, count)


def _section_count(radius: float) -> int:
    """Return how many sections a rim has; a small disc's get too few pixels if they are many."""
    fewest, several, most = SECTIONS
    as_usual = np.clip(round(2.0 * np.pi * radius / SECTION_PX), several, most)
    return int(np.clip(round(several * radius / SMALL_PX), fewest, as_usual))


def _sections(shape_px2: Floats, x: Floats, y: Floats, count: int) -> Indices:
    """Return the section of each pixel, by its angle on the circle that the ellipse was."""
    circle = np.linalg.solve(np.linalg.cholesky(shape_px2), np.stack([x, y]))
    turn = np.arctan2(circle[1], circle[0]) % (2.0 * np.pi)
    return np.minimum((turn * (count / (2.0 * np.pi))).astype(np.int64), count - 1)


def _balance(level: Floats, face: Mask, low: Indices, detector: Detector) -> Floats | None:
    """Return what each pixel is multiplied by so that the disc's face is of one level."""
    if detector.mosaic == "none":
        return np.ones_like(level)
    totals, seen = np.zeros(3), np.zeros(3)
    corners = [(row, column) for row in (0, 1) for column in (0, 1)]
    for row, column in corners:
        colour = RGGB[(row + low[1]) % 2][(column + low[0]) % 2]
        part = (slice(row, None, 2), slice(column, None, 2))
        totals[colour] += level[part][face[part]].sum()
        seen[colour] += np.count_nonzero(face[part])
    if seen.min() < 4 or (totals / np.maximum(seen, 1)).min() <= 1.0:
        return None
    means = totals / seen
    gain = np.empty_like(level)
    for row, column in corners:
        colour = RGGB[(row + low[1]) % 2][(column + low[0]) % 2]
        gain[row::2, column::2] = means[1] / means[colour]
    return gain


def _centre(
    found: FoundEdge, ways: _Ways, known: KnownDisc, radius: float, width: float
) -> LitDisc | str:
    """Lay a disc through the sections that agree."""
    most_misfit = MOST_MISFIT * max(SMALL_PX / radius, 1.0)
    with np.errstate(invalid="ignore"):
        clear = (
            np.isfinite(found.sigma_px)
            & (found.step > LEAST_STEP_SIGMAS * found.step_sigma)
            & (found.misfit < most_misfit)
            & (np.abs(found.offset_px) < width - 1.0)
        )
    if not clear.any():
        return "nothing shows of its rim"
    crossed = ~clear & (np.roll(clear, 1) | np.roll(clear, -1))
    guard = np.roll(crossed & (found.misfit >= most_misfit), 1) | np.roll(
        crossed & (found.misfit >= most_misfit), -1
    )
    clear &= ~guard
    floor_px = np.hypot(SECTION_FLOOR_PX, known.shape_sigma * radius)
    variance = np.where(clear, found.sigma_px, 1.0) ** 2 + floor_px**2
    design = np.column_stack([ways.normals, ways.growth_px])
    used = clear
    solution, covariance = np.zeros(3), np.eye(3)
    for _ in range(ROUNDS):
        if used.sum() < max(5, LEAST_RIM * len(used)):
            share = 100.0 * used.sum() / len(used)
            return f"only {share:.0f} % of its rim shows, lit evenly"
        weight = used / variance
        normal = (design * weight[:, None]).T @ design
        normal[2, 2] += known.size_sigma**-2.0
        covariance = np.linalg.inv(normal)
        solution = covariance @ ((design * weight[:, None]).T @ found.offset_px)
        left = found.offset_px - design @ solution
        spread = 1.4826 * float(np.median(np.abs(left[used])))
        limit = OUTLIER_SIGMAS * np.hypot(max(spread, LEAST_SPREAD_PX), np.sqrt(variance))
        kept = clear & (np.abs(left) < limit)
        if (kept == used).all():
            break
        used = kept
    left = found.offset_px - design @ solution
    chi2 = float((left[used] ** 2 / variance[used]).sum()) / max(int(used.sum()) - 3, 1)
    centre_floor_px = float(np.hypot(CENTRE_FLOOR_PX, CENTRE_FLOOR_SHARE * radius))
    return LitDisc(
        shift_px=solution[:2],
        covariance_px2=max(chi2, 1.0) * covariance[:2, :2] + centre_floor_px**2 * np.eye(2),
        size=1.0 + float(solution[2]),
        rim=float(used.mean()),
        misfit_chi2=chi2,
        blur_px=found.blur_px,
        level_dn=float(np.median(found.step[used])),
    )
