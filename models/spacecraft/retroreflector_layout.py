"""Where the ten retroreflectors of the Maxar-1300 stand.

Opromolla et al. 2022 give them in Figure 4 alone; these coordinates are ours, chosen to satisfy
everything that its text says (sections 3.1 and 5.1.1):

- #1, #2 widest, for accuracy far away; #3, #4 are 1.6 m apart in x and set the field of view;
- #5 to #10 the close group; #7 and #8 in plane and mirror images of each other, #9 breaks their
  symmetry about the y-z plane, #10 stands on a mast, alone out of plane;
- #2, #4 on the +x side; #6 among the farthest from the x axis, and where the field of view, its
  aim 0.27 m towards -x, is about to lose it at 1.8 m together with #1.

The mean of the ten lies on x = 0, so a boresight through it sees #3 to #10 at 1.8 m.
"""

from __future__ import annotations

import numpy as np

from models.markers import MarkerPattern
from models.spacecraft.retroreflector_optics import cubes_behind

RADIUS_M = 0.0127  # section 3.1

# Target frame (origin at the ring's centre, z out of the ring plane), m.
POINTS_IN_TARGET: dict[str, tuple[float, float, float]] = {
    "1": (-1.10, -0.30, 0.0),
    "2": (1.10, -0.30, 0.0),
    "3": (-0.80, -0.65, 0.0),
    "4": (0.80, -0.65, 0.0),
    "5": (-0.445, -0.92, 0.0),
    "6": (0.545, -1.15, 0.0),
    "7": (-0.24, -1.00, 0.0),
    "8": (0.24, -1.00, 0.0),
    "9": (-0.10, -1.15, 0.0),
    "10": (0.0, -0.97, 0.18),
}

NORMALS_IN_TARGET = np.tile([0.0, 0.0, 1.0], (len(POINTS_IN_TARGET), 1))

RETROREFLECTORS = MarkerPattern(
    names=tuple(POINTS_IN_TARGET),
    points_in_target=np.array(list(POINTS_IN_TARGET.values())),
    normals_in_target=NORMALS_IN_TARGET,
    radius_m=RADIUS_M,
    cubes=cubes_behind(NORMALS_IN_TARGET),
)
