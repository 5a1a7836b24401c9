"""Where an arm's links are, and how they move with its joints.

Angles are (n,) arrays in rad. A twist is (6,): angular velocity first, then that of the end
effector's origin, both in the base's axes, as every covariance of the house has rotation first.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from models.arm.arm import Arm
from models.arrays import Floats
from models.pose import RigidTransform


def chain(arm: Arm, angles_rad: ArrayLike) -> Floats:
    """Return the product of the chain up to each link and to the tool.

    Parameters
    ----------
    arm : Arm
    angles_rad : (n,) array, rad

    Returns
    -------
    (n + 2, 4, 4) array
        ``base_from_link`` of links 0 to n, then ``base_from_tool``.

    Raises
    ------
    ValueError
        If there are not as many angles as joints.
    """
    angles = np.asarray(angles_rad, dtype=np.float64)
    count = len(arm.joints)
    if angles.shape != (count,):
        raise ValueError(
            f"expected {count} angles for {arm.name}, one a joint, got shape {angles.shape}"
        )
    cosines, sines = np.cos(angles), np.sin(angles)
    links = np.empty((count + 2, 4, 4))
    links[0] = np.eye(4)
    for k in range(count):
        turned = arm.fixed[k].copy()
        x, y = turned[:3, 0].copy(), turned[:3, 1].copy()
        turned[:3, 0] = cosines[k] * x + sines[k] * y
        turned[:3, 1] = cosines[k] * y - sines[k] * x
        links[k + 1] = links[k] @ turned
    links[count + 1] = links[count] @ arm.fixed[count]
    return links


def base_from_tool(arm: Arm, angles_rad: ArrayLike) -> RigidTransform:
    """Return the pose of the end effector in the arm's base.

    Parameters
    ----------
    arm : Arm
    angles_rad : (n,) array, rad
    """
    return RigidTransform.from_matrix(chain(arm, angles_rad)[-1])


def chaser_from_tool(arm: Arm, angles_rad: ArrayLike) -> RigidTransform:
    """Return the pose of the end effector in the frame of the chaser-fixed camera.

    Parameters
    ----------
    arm : Arm
    angles_rad : (n,) array, rad
    """
    return arm.chaser_from_base @ base_from_tool(arm, angles_rad)


def chaser_from_links(arm: Arm, angles_rad: ArrayLike) -> list[RigidTransform]:
    """Return the pose of links 0 (the base) to n in the frame of the chaser-fixed camera.

    Parameters
    ----------
    arm : Arm
    angles_rad : (n,) array, rad
    """
    return [
        arm.chaser_from_base @ RigidTransform.from_matrix(link)
        for link in chain(arm, angles_rad)[:-1]
    ]


def jacobian(arm: Arm, angles_rad: ArrayLike) -> Floats:
    """Return the end effector's twist by each joint's rate, in the base's axes.

    A joint turns the tool about its axis, and moves it by the axis crossed with the arm from it
    (Siciliano et al. 2009, equation 3.30).

    Parameters
    ----------
    arm : Arm
    angles_rad : (n,) array, rad

    Returns
    -------
    (6, n) array
        Rows: angular velocity, then velocity in m/rad.
    """
    return jacobian_of(chain(arm, angles_rad))


def jacobian_of(links: Floats) -> Floats:
    """Return the Jacobian of a chain whose links are known; see ``jacobian``.

    Parameters
    ----------
    links : (n + 2, 4, 4) array
        As ``chain`` gives them.

    Returns
    -------
    (6, n) array
    """
    axes, places = links[1:-1, :3, 2], links[1:-1, :3, 3]
    return np.concatenate([axes, np.cross(axes, links[-1, :3, 3] - places)], axis=1).T
