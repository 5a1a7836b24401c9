"""Hypothesis strategies for the house's types."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.pose import RigidTransform


def vectors(largest: float) -> st.SearchStrategy[Floats]:
    """Three numbers, each at most ``largest`` in size."""
    return st.tuples(*[st.floats(-largest, largest)] * 3).map(np.array)


def rigid_transforms(largest_m: float = 20.0) -> st.SearchStrategy[RigidTransform]:
    """Any attitude, and an origin within a cube of half side ``largest_m``."""
    return st.builds(
        lambda turn, shift: RigidTransform(Rotation.from_rotvec(turn).as_matrix(), shift),
        vectors(np.pi),
        vectors(largest_m),
    )
