"""Arms and poses for tests: drawn ones, and the house's where it goes."""

from __future__ import annotations

import numpy as np

from models.arm.arm import Arm, Joint
from models.arm.arm_file import links_as_capsules
from models.arrays import Floats
from models.pose import RigidTransform


def drawn_arm(rng: np.random.Generator, joints: int = 7) -> Arm:
    """Return an arm of links of up to half a metre, turned anyhow."""
    from scipy.spatial.transform import Rotation

    def placed() -> RigidTransform:
        return RigidTransform(Rotation.random(rng=rng).as_matrix(), rng.uniform(-0.5, 0.5, 3))

    chain = tuple(Joint(f"j{k}", placed(), -2.5, 2.5) for k in range(joints))
    tool = placed()
    return Arm("drawn", placed(), chain, tool, links_as_capsules(chain, tool, [0.04] * joints))


def drawn_angles(arm: Arm, rng: np.random.Generator) -> Floats:
    """Return angles within the limits, (n,), rad."""
    return arm.lower_rad + rng.random(len(arm.joints)) * (arm.upper_rad - arm.lower_rad)
