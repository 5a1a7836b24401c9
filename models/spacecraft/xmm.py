"""XMM-Newton, whole: an X-ray observatory of 10.8 by 16.16 m, deployed.

Body frame at the centre of mass: x along the telescope towards the sky, wings along +-y, z towards
the Sun. Sizes and their sources are in ``xmm_layout``.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from models.pose import RigidTransform
from models.spacecraft import xmm_layout as at
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.xmm_service_module import service_module_parts
from models.spacecraft.xmm_telescope import telescope_parts


@lru_cache(maxsize=1)
def xmm() -> Spacecraft:
    """Build the satellite; built once, the same triangles every time."""
    return Spacecraft(
        name="xmm",
        parts=(*service_module_parts(), *telescope_parts(), *_wing(1.0), *_wing(-1.0)),
        markers=None,
        centre_of_mass=np.zeros(3),
    )


def _wing(sign: float) -> tuple[Part, ...]:
    """Return the wing on the +y (``sign`` 1) or -y (-1) side; cells face the Sun, +z."""
    side = "plus_y" if sign > 0.0 else "minus_y"
    turn = np.diag([sign, sign, 1.0])  # half a turn about z, or none
    return at.WING.parts(side, RigidTransform(turn, np.array([at.WING_X, 0.0, at.WING_Z])))
