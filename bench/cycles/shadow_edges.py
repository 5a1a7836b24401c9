"""How far a shadow's edge in one render lies from the same edge in another, in pixels.

Where edges are is told by rays, not by the images: a pixel whose centre the Sun reaches beside one
whose centre it does not, on the same smooth piece of surface. Across each such edge the brightness
of either image falls from a lit level to a dark one. The edge is where a sharp step would give as
much light in all: pixels average over their area, so that place is kept where a half-way crossing
strays by a tenth of a pixel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from models.arrays import Floats, Labels, Mask, Radiance

TOLERANCE_PX = 0.5
REACH_PX = 4.0  # of a profile, to either side of its edge
STEP_PX = 0.1
PLATEAU_PX = 3.0  # from here on outwards a profile has its lit or its dark level
SMOOTH_COSINE = 0.995  # between normals along a profile: shading alone moves nothing
SOFTENED_PX = 1.5  # the mask of lit pixels, before its slope is taken
UNSURE_PX = 1.5  # nearer to the edge than this, a pixel's centre may be lit or not
LEAST_CONTRAST = 0.5  # of a fall, relative to the lit level
FLAT = 0.15  # most that a level may vary, relative to the fall


@dataclass(frozen=True, eq=False)
class ShadowEdges:
    """Places on shadow edges and the way from dark to lit.

    Attributes
    ----------
    points_px : (n, 2) array, px
        Column and row.
    directions : (n, 2) array
        Unit vectors.
    """

    points_px: Floats
    directions: Floats


def find_edges(labels: Labels, normals: Radiance, facing: Mask, lit: Mask) -> ShadowEdges:
    """Return the shadow edges on smooth pieces of surface that face the Sun.

    Parameters
    ----------
    labels : (height, width) array
    normals : (height, width, 3) array
        Unit normals.
    facing : (height, width) bool array
        Whether the surface at a pixel's centre faces the Sun.
    lit : (height, width) bool array
        Whether the Sun's centre is seen from there.
    """
    edge = lit & ~ndimage.binary_erosion(lit, np.ones((3, 3), dtype=bool)) & (labels > 0)
    soft = ndimage.gaussian_filter(lit.astype(np.float64), SOFTENED_PX)
    slope = np.stack([ndimage.sobel(soft, axis=1), ndimage.sobel(soft, axis=0)], axis=-1)
    steepness = np.linalg.norm(slope, axis=-1)
    rows, columns = np.nonzero(edge & (steepness > 0.0))
    points = np.stack([columns, rows], axis=1).astype(np.float64)
    directions = slope[rows, columns] / steepness[rows, columns][:, None]
    along = np.arange(-np.ceil(REACH_PX), np.ceil(REACH_PX) + 1.0)
    places = np.rint(points[:, None, :] + along[None, :, None] * directions[:, None, :])
    height, width = labels.shape
    border = np.ceil(4.0 * SOFTENED_PX)  # nearer than this the slope is not to be trusted
    inside = (places >= 0.0).all(axis=(1, 2)) & (places < [width, height]).all(axis=(1, 2))
    inside &= ((points >= border) & (points < [width - border, height - border])).all(axis=1)
    points, directions, places = points[inside], directions[inside], places[inside].astype(np.intp)
    at = (places[..., 1], places[..., 0])
    centre = normals[points[:, 1].astype(np.intp), points[:, 0].astype(np.intp)]
    flat = (normals[at] * centre[:, None, :]).sum(axis=2) > SMOOTH_COSINE
    one_piece = (labels[at] == labels[at][:, :1]) & facing[at] & flat
    falls_once = (lit[at] == (along >= 0.0)) | (np.abs(along) < UNSURE_PX)
    chosen = (one_piece & falls_once).all(axis=1)
    return ShadowEdges(points[chosen], directions[chosen])


def edge_places(image: Radiance, edges: ShadowEdges) -> Floats:
    """Return where along its direction each edge lies in an image, px; NaN where it is unclear.

    A profile is clear if it has two flat levels, the lit one at least twice the dark one.

    Parameters
    ----------
    image : (height, width) array, W m-2 sr-1
    edges : ShadowEdges

    Returns
    -------
    (n,) array, px
    """
    along = np.linspace(-REACH_PX, REACH_PX, 2 * round(REACH_PX / STEP_PX) + 1)
    places = edges.points_px[:, None, :] + along[None, :, None] * edges.directions[:, None, :]
    rows_columns = [places[..., 1], places[..., 0]]
    profiles = ndimage.map_coordinates(image.astype(np.float64), rows_columns, order=1)
    dark, bright = profiles[:, along <= -PLATEAU_PX], profiles[:, along >= PLATEAU_PX]
    low, high = dark.mean(axis=1), bright.mean(axis=1)
    fall = high - low
    share = (profiles - low[:, None]) / np.where(fall > 0.0, fall, 1.0)[:, None]
    lit_px = (share[:, 1:] + share[:, :-1]).sum(axis=1) * 0.5 * STEP_PX
    places_px = REACH_PX - lit_px
    flat = np.maximum(np.ptp(dark, axis=1), np.ptp(bright, axis=1)) < FLAT * np.abs(fall)
    clear = flat & (fall > LEAST_CONTRAST * high)
    return np.where(clear, places_px, np.nan)


@dataclass(frozen=True)
class EdgeShifts:
    """How far edges of two renders lie apart.

    Attributes
    ----------
    edges : int
        How many are clear in both.
    mean_px, median_abs_px, worst_of_95_percent_px : float, px
        Mean with its sign (ours beyond theirs, towards the light); middle and 95th percentile of
        its absolute value.
    """

    edges: int
    mean_px: float
    median_abs_px: float
    worst_of_95_percent_px: float

    @property
    def agrees(self) -> bool:
        """Whether 95 of 100 edges are within tolerance."""
        return self.edges > 0 and self.worst_of_95_percent_px <= TOLERANCE_PX


def edge_shifts(ours: Radiance, theirs: Radiance, edges: ShadowEdges) -> EdgeShifts:
    """Compare where edges lie in two renders.

    Parameters
    ----------
    ours, theirs : (height, width) arrays, W m-2 sr-1
    edges : ShadowEdges
    """
    shift = edge_places(ours, edges) - edge_places(theirs, edges)
    shift = shift[np.isfinite(shift)]
    if len(shift) == 0:
        return EdgeShifts(0, float("nan"), float("nan"), float("nan"))
    size = np.abs(shift)
    return EdgeShifts(
        edges=len(shift),
        mean_px=float(shift.mean()),
        median_abs_px=float(np.median(size)),
        worst_of_95_percent_px=float(np.percentile(size, 95.0)),
    )
