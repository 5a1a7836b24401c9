"""What a solid corner cube returns, place by place, by following rays through it: no formula.

A ray goes in through the round face, is bent, mirrored by the three planes that meet at the apex,
bent again, and comes out inside the face, or not. Where it meets a mirror within the width of an
edge's bevel it is lost. The face is one of radius 1, and places are told from where the apex is
seen, as markers' points are.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Mask

DEPTH = np.sqrt(2.0)  # of the apex under a face of radius 1, whose rim the mirrors' corners meet
REFLECTIONS = 3


def comes_back(
    x: Floats, y: Floats, towards: Floats, refractive_index: float, edge_share: float
) -> Mask:
    """Tell where light that comes from a direction goes back there.

    Parameters
    ----------
    x, y : (n,) arrays
        Along the face, the first over one of the cube's edges, from where the apex is seen.
    towards : (3,) array
        Unit vector to the viewer, in these axes and the outward normal.
    refractive_index : float
    edge_share : float
        Half-width of a bevel, over the radius.
    """
    flat = -np.asarray(towards)[:2] / refractive_index
    along = np.array([*flat, -np.sqrt(1.0 - flat @ flat)])
    apex = np.array([0.0, 0.0, -DEPTH])
    seen_at = apex - along / along[2] * apex[2]
    place = np.stack([x, y, np.zeros_like(x)], axis=1) + seen_at
    lit = np.hypot(place[:, 0], place[:, 1]) < 1.0
    edges = np.array(
        [
            [np.sqrt(2.0 / 3.0) * np.cos(a), np.sqrt(2.0 / 3.0) * np.sin(a), np.sqrt(1.0 / 3.0)]
            for a in np.deg2rad((0.0, 120.0, 240.0))
        ]
    )  # square to each other: each is the normal of the mirror between the other two
    place, way = (place - apex) @ edges.T, np.repeat((along @ edges.T)[None], len(x), axis=0)
    for _ in range(REFLECTIONS):
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = np.where(way < -1e-12, -place / way, np.inf)
        reach = np.where(reach > 1e-9, reach, np.inf)
        which = reach.argmin(axis=1)
        rows = np.arange(len(x))
        nearest = reach[rows, which]
        lit &= np.isfinite(nearest)
        place = place + np.where(np.isfinite(nearest), nearest, 0.0)[:, None] * way
        off_edges = np.sort(np.abs(place), axis=1)[:, 1]  # from the nearer edge of that mirror
        lit &= off_edges > edge_share
        way[rows, which] *= -1.0
    place, way = place @ edges + apex, way @ edges
    leave = place - way / way[:, 2:] * place[:, 2:]
    return np.asarray(lit & (np.hypot(leave[:, 0], leave[:, 1]) < 1.0))
