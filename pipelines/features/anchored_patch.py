"""Where a place is in an image, by how it looked when it was born, stretched as it has turned.

A tracker that compares each image with the last one drifts: a patch that turns away is sheared, a
shift alone fits it with the same small error every time. Here all tracks are fitted at once to
their first patches by an affine map each, brightness and contrast left free (Lucas and Kanade in
Baker and Matthews' inverse compositional form, 2004; affine as by Shi and Tomasi 1994).
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from models.arrays import Floats, Labels, Mask

HALF_PX = 8
ITERATIONS = 10
SETTLED_PX = 0.005
UNKNOWNS = 6
_ACROSS, _DOWN = (
    each.ravel().astype(np.float64)
    for each in np.meshgrid(np.arange(-HALF_PX, HALF_PX + 1), np.arange(-HALF_PX, HALF_PX + 1))
)
GRID = np.stack([_ACROSS, _DOWN])
_ONE = np.eye(2)


@dataclass(frozen=True, eq=False)
class Anchors:
    """First looks of some places.

    Attributes
    ----------
    patches : (n, p) array
        Of mean 0 and length 1.
    descents : (n, p, 6) array
        Their slopes by shift and affine map.
    """

    patches: Floats
    descents: Floats

    @classmethod
    def none(cls) -> Anchors:
        """Return none at all."""
        size = GRID.shape[1]
        return cls(np.zeros((0, size)), np.zeros((0, size, UNKNOWNS)))

    @classmethod
    def of(cls, grey: Labels, points_px: Floats) -> Anchors:
        """Return the looks of places in an image.

        Parameters
        ----------
        grey : (height, width) uint8 array
        points_px : (n, 2) array, px
        """
        identity = np.tile(_ONE, (len(points_px), 1, 1))
        looks = _sampled(grey, points_px, identity)
        side = 2 * HALF_PX + 1
        patches, lengths = _normalised(looks)
        square = looks.reshape(-1, side, side) / lengths[:, None, None]
        down, right = np.gradient(square, axis=(1, 2)) if len(square) else (square, square)
        right, down = right.reshape(-1, side**2), down.reshape(-1, side**2)
        slopes = [right, down, right * GRID[0], right * GRID[1], down * GRID[0], down * GRID[1]]
        descents = np.stack(slopes, axis=2)
        return cls(patches, descents - descents.mean(axis=1, keepdims=True))

    def take(self, which: Mask) -> Anchors:
        """Return some of them.

        Parameters
        ----------
        which : (n,) bool array
        """
        return Anchors(self.patches[which], self.descents[which])

    def followed_by(self, other: Anchors) -> Anchors:
        """Return both, one after the other."""
        return Anchors(
            np.concatenate([self.patches, other.patches]),
            np.concatenate([self.descents, other.descents]),
        )


@dataclass(frozen=True, eq=False)
class Fitted:
    """Places as their first looks have them.

    Attributes
    ----------
    points_px : (n, 2) array, px
    maps : (n, 2, 2) array
        From first look to image.
    likeness : (n,) array
        Correlation with the first look.
    sigma_px : (n,) array, px
        1 sigma per axis, by what is left of the difference.
    """

    points_px: Floats
    maps: Floats
    likeness: Floats
    sigma_px: Floats


def fitted(grey: Labels, anchors: Anchors, points_px: Floats, maps: Floats) -> Fitted:
    """Fit first looks to an image.

    Parameters
    ----------
    grey : (height, width) uint8 array
    anchors : Anchors
    points_px : (n, 2) array, px
        Where to begin.
    maps : (n, 2, 2) array
    """
    count = len(points_px)
    if count == 0:
        return Fitted(points_px, maps, np.zeros(0), np.zeros(0))
    turned = anchors.descents.transpose(0, 2, 1)
    normal = turned @ anchors.descents
    normal = normal + 1e-9 * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(UNKNOWNS)
    inverse = np.linalg.inv(normal)
    points, maps = points_px.copy(), maps.copy()
    for _ in range(ITERATIONS):
        patches, _ = _normalised(_sampled(grey, points, maps))
        step = (inverse @ (turned @ (patches - anchors.patches)[..., None]))[..., 0]
        step[:, :2] = np.clip(step[:, :2], -1.0, 1.0)
        step[:, 2:] = np.clip(step[:, 2:], -0.1, 0.1)
        back = np.linalg.inv(_ONE + step[:, 2:].reshape(-1, 2, 2))
        maps = maps @ back
        moved = (maps @ step[:, :2, None])[..., 0]
        points -= moved
        if float(np.abs(moved).max()) < SETTLED_PX:
            break
    patches, _ = _normalised(_sampled(grey, points, maps))
    left = np.sum((patches - anchors.patches) ** 2, axis=1) / (GRID.shape[1] - UNKNOWNS)
    spread = 0.5 * (inverse[:, 0, 0] + inverse[:, 1, 1]) * left
    grown = np.abs(np.linalg.det(maps))
    likeness = np.sum(patches * anchors.patches, axis=1)
    return Fitted(points, maps, likeness, np.sqrt(spread * grown))


def _sampled(grey: Labels, points: Floats, maps: Floats) -> Floats:
    """Return the image under each map, (n, p)."""
    places = np.einsum("nij,jp->nip", maps, GRID) + points[:, :, None]
    x, y = (places[:, axis].astype(np.float32) for axis in (0, 1))
    looks = cv2.remap(grey, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(looks, dtype=np.float64).reshape(len(points), -1)


def _normalised(looks: Floats) -> tuple[Floats, Floats]:
    centred = looks - looks.mean(axis=1, keepdims=True) if len(looks) else looks
    lengths = np.maximum(np.linalg.norm(centred, axis=1), 1.0)
    return centred / lengths[:, None], lengths
