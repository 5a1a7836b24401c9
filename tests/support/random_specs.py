"""Specifications of small random datasets, and a spacecraft that is quickly drawn about."""

from __future__ import annotations

from typing import Any

import numpy as np
import trimesh

from bench.random_dataset.draws import Aim
from bench.random_dataset.spec_tables import Spec
from models.spacecraft.part import Part, Spacecraft

NEAR_M, FAR_M = 10.0, 80.0


def spec_of(**changed: Any) -> Spec:
    """Return a specification of one target and camera, with some keys changed."""
    table: dict[str, Any] = {
        "name": "small",
        "frames": 20,
        "target": [{"spacecraft": "hispasat"}],
        "camera": [{"name": "wide", "width": 64}],
        "pose": {"range_m": [NEAR_M, FAR_M]},
    }
    return Spec(**{**table, **changed})


def box(size_m: float = 2.0) -> Spacecraft:
    """Return a cube about the point (1, 0, 0) m."""
    mesh = trimesh.creation.box((size_m,) * 3)
    mesh.apply_translation([1.0, 0.0, 0.0])
    return Spacecraft("box", (Part("box", mesh, "white_paint"),), None, np.zeros(3))


def aim_at_box(near_m: float = NEAR_M, far_m: float = FAR_M) -> Aim:
    """Return the cube, aimed at its middle."""
    return Aim(box(), np.array([1.0, 0.0, 0.0]), (near_m, far_m))
