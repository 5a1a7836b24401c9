"""Where things lie on XMM-Newton: the dimensions that its mesh and its wireframe both come from.

Body frame of Pesce et al. 2019, Fig. 3a: origin at the centre of mass, x along the telescope
towards the sky, wings along +-y, z towards the Sun. Read in their sources: about 10 m of length and
16 m of span; mirrors and cameras 7.5 m apart (van Katwijk, van der Laan and Stramaccioni 1999, ESA
Bulletin 100, 44); a service module that is a closed box of two platforms and four side panels round
a hole of 2.10 m ("The Service Module", XMM-Newton pages of ESA); halves joined by 64 bolts along a
ring some 6 m round, so 1.9 m wide ("XMM now standing 10 metres tall", ESA 1999); dark foil on tube
and module, bright on the sunshield, thruster pairs on dark boxes, an S-band antenna on a tripod
("Space selfie from XMM-Newton", ESA 2016). As commonly quoted after Barre, Nye and Janin 1999 (ESA
Bulletin 100, 15), and not checked against a copy: 10.8 m, 16.16 m, a tube of 6.8 m, panels of 1.94
by 1.81 m, three a wing. The rest is ours: no public drawing gives it, and it only has to fit the
launcher and the pictures.
"""

from __future__ import annotations

from models.spacecraft.panel_wing import PanelWing

# Along x, m. The centre of mass lies 1 m behind the service module: see ``mass_model``.
SUNSHIELD_TOP_X = 3.10
BAFFLE_X = 2.72  # mouths of the mirror baffles
SERVICE_X = (1.00, 1.95)
JOINT_X = -2.35  # where the tube's halves meet
FOCAL_X = (-6.85, -5.70)  # the focal plane assembly
HORN_X = -7.70  # mouths of the two MOS radiators

SERVICE_HALF_Y, SERVICE_HALF_Z = 1.65, 1.50
LOWER_TUBE_M, UPPER_TUBE_M, JOINT_M = 1.05, 0.95, 1.08  # radii
FOCAL_HALF_Y = 1.12
FOCAL_Z = (-1.35, 1.00)

# The sunshield's plan, (y, z) m, from the fold between its flat and its slanted panel outwards.
SHIELD_FOLD = (0.90, 1.42)
SHIELD_EDGE = (1.55, 0.55)
SHIELD_EDGE_TOP_X = 2.55
SHIELD_M = 0.010  # thickness

BAFFLE_M, BAFFLE_FROM_AXIS_M = 0.42, 0.58
MIRRORS_DEG = (-90.0, 30.0, 150.0)  # of the three telescopes round x, from y to z
ADAPTOR_M = 1.312  # radius of Ariane 5's 2624 mm interface
HORNS_YZ = ((-0.52, -0.40), (0.52, -0.40))
HORN_M = (0.13, 0.36)  # radius at the foot and at the mouth

OUTGASSING_LOW, OUTGASSING_HIGH = (-5.45, -0.38, -1.38), (-4.05, 0.38, -0.70)
POD_M = (0.34, 0.26, 0.26)  # of the boxes that carry pairs of thrusters
PODS_YZ = ((-1.38, -1.22), (1.38, -1.22), (1.38, 1.22), (-1.38, 1.22))

WING_X, WING_Z = 1.475, 0.45  # of the wings' axis and of their cells' side
WING = PanelWing(
    panels=3,
    panel_m=(1.94, 1.81),
    root_m=SERVICE_HALF_Y,
    drive_m=0.12,
    yoke_m=0.80,
    yoke_half_m=0.70,
    gap_m=0.04,
    thickness_m=0.020,
    rim_m=0.016,
    rim_proud_m=0.001,
    hinges_m=(-0.65, 0.65),
    hold_downs_m=((-0.55, -0.48), (0.55, -0.48), (-0.55, 0.48), (0.55, 0.48)),
    seed=1999,
)
