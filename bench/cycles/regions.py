"""Mean radiance over regions of two renders, with the error that Monte-Carlo noise leaves.

A region is what one label and one material cover, less a rim: there, where pixels are shared, two
renderers may differ by a fraction of a pixel and both be right.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from bench.cycles.neutral_scene import NeutralMaterial
from models.arrays import Floats, Labels, Mask, Radiance

TOLERANCE = 0.01
RIM_PX = 2
FEWEST_PIXELS = 150
KNOWN_WITHIN = 0.003  # standard error of a ratio, beyond which noise hides a one-percent fault
NEARLY_ALL = 0.85  # share of one part, from which on a material counts as that kind
DIFFUSE, CONDUCTOR, BLEND = "diffuse", "rough conductor", "blend"


@dataclass(frozen=True)
class RegionMeans:
    """Two renderers' mean radiance over one region.

    Attributes
    ----------
    name : str
    pixels : int
    ours, theirs : float, W m-2 sr-1
    ratio_error : float
        Standard error of ``ratio``, from the scatter between seeds.
    """

    name: str
    pixels: int
    ours: float
    theirs: float
    ratio_error: float

    @property
    def ratio(self) -> float:
        """Ours over theirs."""
        return self.ours / self.theirs if self.theirs > 0.0 else float("nan")

    @property
    def telling(self) -> bool:
        """Whether the region is large and quiet enough for a fault of one percent to show."""
        return self.pixels >= FEWEST_PIXELS and self.ratio_error <= KNOWN_WITHIN

    @property
    def agrees(self) -> bool:
        """Whether the two are within tolerance."""
        return abs(self.ratio - 1.0) <= TOLERANCE


def kind_of(material: NeutralMaterial) -> str:
    """Return whether a material is nearly all diffuse, nearly all rough conductor, or a blend."""
    total = max(material.diffuse + material.specular, 1e-9)
    if material.diffuse / total >= NEARLY_ALL:
        return DIFFUSE
    return CONDUCTOR if material.specular / total >= NEARLY_ALL else BLEND


def interiors(labels: Labels, rim_px: int = RIM_PX) -> dict[int, Mask]:
    """Return the pixels of each label that lie more than ``rim_px`` inside it; 0 is space.

    Parameters
    ----------
    labels : (height, width) uint8 array
    rim_px : int, px

    Returns
    -------
    dict of int to (height, width) arrays of bool
    """
    square = np.ones((3, 3), dtype=bool)
    return {
        int(label): ndimage.binary_erosion(labels == label, square, iterations=rim_px)
        for label in np.unique(labels)
        if label != 0
    }


def region_means(
    name: str, region: Mask, ours: Sequence[Radiance], theirs: Sequence[Radiance]
) -> RegionMeans:
    """Compare two renderers over a region, from two or more seeds of each.

    Parameters
    ----------
    name : str
    region : (height, width) array of bool
    ours, theirs : sequences of (height, width) arrays, W m-2 sr-1
        One image a seed, two or more.
    """
    a, b = (
        np.array([float(image[region].mean()) for image in images]) for images in (ours, theirs)
    )

    def relative_error(means: Floats) -> float:
        mean = float(means.mean())
        spread = float(means.std(ddof=1)) / np.sqrt(len(means))
        return spread / mean if mean > 0.0 else float("inf")

    return RegionMeans(
        name=name,
        pixels=int(region.sum()),
        ours=float(a.mean()),
        theirs=float(b.mean()),
        ratio_error=float(np.hypot(relative_error(a), relative_error(b))),
    )


def compare_regions(
    labels: Labels,
    names: Sequence[str],
    kinds: Mapping[str, str],
    ours: Sequence[Radiance],
    theirs: Sequence[Radiance],
) -> tuple[list[RegionMeans], list[RegionMeans]]:
    """Compare two renderers over every region and over every kind of material.

    Parameters
    ----------
    labels : (height, width) array
        0 is space, k + 1 means ``names[k]``.
    names : sequence of str
    kinds : dict of str, by name
    ours, theirs : sequences of (height, width) arrays, W m-2 sr-1
        One for each seed.

    Returns
    -------
    (kinds, regions) : two lists of RegionMeans, those with pixels.
    """
    inside = interiors(labels)
    regions = [
        region_means(names[label - 1], mask, ours, theirs)
        for label, mask in inside.items()
        if mask.any()
    ]
    totals = []
    for kind in (DIFFUSE, CONDUCTOR, BLEND):
        masks = [mask for label, mask in inside.items() if kinds[names[label - 1]] == kind]
        joined = np.logical_or.reduce(masks) if masks else np.zeros(labels.shape, dtype=bool)
        if joined.any():
            totals.append(region_means(kind, joined, ours, theirs))
    return totals, regions
