"""Hispasat 36W-1's wireframe: 20 corners that an image shows, and a hull that hides them.

Wing corners lie in the middle of the sheet's thickness. No turn carries the craft onto itself, but
half a turn about y comes near: it carries the wings to 0.2 m from themselves and the body to 0.4 m,
the Earth deck where the launcher's was; only the active antenna's corners lie 1 m and more from any
other. Half a turn about z carries the body's corners onto themselves, and the wings, which stand
askew, 0.9 m away.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from models.spacecraft import hispasat_layout as at
from models.spacecraft.hull import Outline, box_outline, dish_outline, sheet_outline, wireframe
from models.wireframe.wireframe import Wireframe

SIDES = {"plus_y": 1.0, "minus_y": -1.0}


def hispasat_wireframe() -> Wireframe:
    """Build the wireframe from the dimensions of the mesh."""
    body = box_outline("body", at.BODY_LOW, at.BODY_HIGH)
    return wireframe("hispasat", [*_wings(), body, _active_antenna(), *_dishes()])


def wing_corners(sign: float) -> Floats:
    """Return a wing's corners: inner low, tip low, tip high and inner high in z, (4, 3) m."""
    x = 0.5 * at.WING.panel_m[0] * sign * np.array([1.0, 1.0, -1.0, -1.0])
    y = np.array([at.WING.inner_m, at.WING.tip_m, at.WING.tip_m, at.WING.inner_m])
    flat = np.column_stack([x, y, np.full(4, -0.5 * at.WING.thickness_m)])
    return at.body_from_wing(sign) @ flat


def _wings() -> list[Outline]:
    ends = ("inner_low", "tip_low", "tip_high", "inner_high")
    return [
        sheet_outline(
            f"wing_{side}", tuple(f"wing_{side}_{end}" for end in ends), wing_corners(sign)
        )
        for side, sign in SIDES.items()
    ]


def _active_antenna() -> Outline:
    """Return the active antenna's box; only its top corners stand clear of the deck."""
    whole = box_outline("active_antenna", at.ACTIVE_LOW, at.ACTIVE_HIGH)
    top = [i for i, name in enumerate(whole.names) if name.endswith("plus_z")]
    edges = tuple((top.index(i), top.index(j)) for i, j in whole.edges if i in top and j in top)
    names = tuple(whole.names[i] for i in top)
    return Outline(whole.component, names, whole.points[top], edges, whole.triangles)


def _dishes() -> list[Outline]:
    return [dish_outline(at.DISH, at.body_from_dish(sign)) for sign in (1.0, -1.0)]
