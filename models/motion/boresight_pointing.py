"""A camera that is kept pointing at a target, without any turn about its boresight.

Volpe et al. 2017, section 3.2: from the Hill frame to the camera by two turns, 3-1-0. The first
brings the camera's x into the plane of the Hill frame's first two axes, the second its z onto the
target; there is no third. The paper's Hill frame has axis 1 along the radius, axis 2 along the
orbit's momentum and so axis 3 against the motion; elsewhere the local frame is (x radial, y along
track, z normal).
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats

HILL_FROM_LVLH = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
ALONG_TRACK = 1e-9  # of the distance: nearer to axis 3 than this, x could be anything


def cam_from_hill(rho_in_hill: Floats) -> Floats:
    """Return the (3, 3) attitude of a camera that looks at the target.

    Parameters
    ----------
    rho_in_hill : (3,) array, m
        From the target to the chaser, in the paper's Hill frame.

    Raises
    ------
    ValueError
        If the chaser is straight ahead or behind: then the turn about the boresight is open.
    """
    forward = -rho_in_hill / np.linalg.norm(rho_in_hill)
    across = float(np.hypot(forward[0], forward[1]))
    if not across > ALONG_TRACK:
        raise ValueError(f"expected a chaser off the along-track axis, got {rho_in_hill} m")
    # R1(b) R3(a): the third row is (sin b sin a, -sin b cos a, cos b).
    sin_a, cos_a = forward[0] / across, -forward[1] / across
    right = np.array([cos_a, sin_a, 0.0])
    return np.array([right, np.cross(forward, right), forward])


def cam_from_lvlh(rho_in_lvlh: Floats) -> Floats:
    """Return the (3, 3) attitude of the same camera, from the local frame.

    Parameters
    ----------
    rho_in_lvlh : (3,) array, m
        From the target to the chaser: radial, along track, normal.

    Raises
    ------
    ValueError
        As ``cam_from_hill``.
    """
    return cam_from_hill(HILL_FROM_LVLH @ rho_in_lvlh) @ HILL_FROM_LVLH
