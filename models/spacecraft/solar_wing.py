"""The Maxar-1300's solar wings: five panels a side, along +-y.

Panels of a 1300 stow against the +-y faces, so one is no larger than 2.4 by 3.6 m; five a side
give a span of 29 m.
"""

from __future__ import annotations

import numpy as np

from models.pose import RigidTransform
from models.spacecraft.bus import HALF_M
from models.spacecraft.panel_wing import PanelWing
from models.spacecraft.part import Part

WING_Z_M = -1.95
WING = PanelWing(
    panels=5,
    panel_m=(3.30, 2.25),
    root_m=HALF_M,
    drive_m=0.16,
    yoke_m=1.70,
    yoke_half_m=1.2,
    gap_m=0.04,
    thickness_m=0.025,
    rim_m=0.018,
    rim_proud_m=0.003,
    hinges_m=(-1.2, 1.2),
    hold_downs_m=((-1.05, -0.62), (1.05, -0.62), (-1.05, 0.62), (1.05, 0.62), (0.0, 0.0)),
    seed=1300,
)


def solar_wing_parts(sign: float) -> tuple[Part, ...]:
    """Return the wing on the +y (``sign`` 1) or -y (-1) side; cells face +z, towards the chaser."""
    side = "plus_y" if sign > 0.0 else "minus_y"
    turn = np.diag([sign, sign, 1.0])  # half a turn about z, or none
    return WING.parts(side, RigidTransform(turn, np.array([0.0, 0.0, WING_Z_M])))
