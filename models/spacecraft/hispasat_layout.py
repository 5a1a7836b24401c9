"""Where things lie on Hispasat 36W-1: the dimensions that its mesh and its wireframe come from.

The first SmallGEO. Body frame at the centre of mass: z to the Earth, wings along +-y (north and
south), x to the east. Published: a body of 2.3 by 1.9 by 2.5 m and two wings of 9 m ("SmallGEO",
German Wikipedia, after eoPortal); 3220 kg at launch (CNES press release, January 2017); Ku- and
Ka-band repeaters behind deployable reflectors and an active receiving antenna (ESA press release
4-2017). Which edge is which, the panels, the reflectors and the deck are ours.
"""

from __future__ import annotations

import numpy as np

from models.pose import RigidTransform
from models.spacecraft.offset_dish import OffsetDish
from models.spacecraft.panel_wing import PanelWing

BODY_LOW = (-1.15, -0.95, -1.05)
BODY_HIGH = (1.15, 0.95, 1.45)
RADIATOR_M = (1.96, 2.16)  # along x and along z, on both y faces
RADIATOR_Z = 0.20

WING_Z = 0.10  # of the wings' axis
WING_TURN_DEG = 25.0  # of both wings about y from cells facing the Earth: where the drives stopped
WING = PanelWing(
    panels=3,
    panel_m=(2.20, 2.40),
    root_m=BODY_HIGH[1],
    drive_m=0.16,
    yoke_m=1.56,
    yoke_half_m=0.80,
    gap_m=0.04,
    thickness_m=0.022,
    rim_m=0.016,
    rim_proud_m=0.001,
    hinges_m=(-0.75, 0.75),
    hold_downs_m=((-0.65, -0.70), (0.65, -0.70), (-0.65, 0.70), (0.65, 0.70)),
    seed=3601,
)

# The reflectors in a frame turned by half a turn about x, where they look along -z.
DISH = OffsetDish(
    diameter_m=1.8,
    focal_length_m=1.5,
    axis_x_m=1.25,
    vertex_z_m=-0.05,
    clearance_m=0.30,
    shell_m=0.020,
)

# The active receiving antenna on the Earth deck.
ACTIVE_LOW, ACTIVE_HIGH = (-0.55, 0.00, 1.45), (0.25, 0.80, 1.87)


def body_from_wing(sign: float) -> RigidTransform:
    """Return the pose of the wing on the +y (``sign`` 1) or -y (-1) side; see ``PanelWing``."""
    turn = np.deg2rad(WING_TURN_DEG)
    about_y = np.array(
        [
            [np.cos(turn), 0.0, np.sin(turn)],
            [0.0, 1.0, 0.0],
            [-np.sin(turn), 0.0, np.cos(turn)],
        ]
    )
    half_turn = np.diag([sign, sign, 1.0])  # about z, or none
    return RigidTransform(about_y @ half_turn, np.array([0.0, 0.0, WING_Z]))


def body_from_dish(sign: float) -> RigidTransform:
    """Return the pose of the dish on the +x (``sign`` 1) or -x (-1) side; see ``OffsetDish``."""
    return RigidTransform(np.diag([sign, -sign, -1.0]), np.zeros(3))
