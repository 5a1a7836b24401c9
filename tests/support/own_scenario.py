"""What a user may bring into a scenario: a camera, poses, markers, and errors of what is told."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.motion.pose_table import pose_columns
from models.pose import RigidTransform

OWN_CAMERA: dict[str, Any] = {
    "width": 1920,
    "height": 1200,
    "fx": 2210.0,
    "fy": 2190.0,
    "cx": 987.3,
    "cy": 571.8,
    "k1": -0.22,
}

OWN_MARKERS: dict[str, Any] = {
    "radius_m": 0.02,
    "marker": [
        {"name": name, "point_in_target_m": point, "normal_in_target": [0.0, 0.0, 1.0]}
        for name, point in {
            "a": [-0.6, -0.6, 0.05],
            "b": [0.6, -0.6, 0.05],
            "c": [0.5, 0.7, 0.05],
            "d": [-0.6, 0.5, 0.05],
            "e": [0.1, -0.9, 0.3],
        }.items()
    ],
}


def facing(
    range_m: float, turn_deg: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> RigidTransform:
    """Return a camera that looks along the target's -z from a distance, the target turned."""
    turn = Rotation.from_euler("xyz", turn_deg, degrees=True).as_matrix()
    return RigidTransform(turn @ np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, range_m]))


def row_of(time_s: float, cam_from_target: RigidTransform, *more: float) -> str:
    """Return a row of a table of poses, every digit kept."""
    wxyz = Rotation.from_matrix(cam_from_target.rotation).as_quat(scalar_first=True)
    numbers: Floats = np.array([time_s, *cam_from_target.translation, *wxyz, *more])
    return ",".join(repr(float(x)) for x in numbers)


def pose_lines(count: int, step_s: float = 1.0) -> list[str]:
    """Return a table of a camera that comes down from 6 m while the target turns a little."""
    rows = [
        row_of(step_s * k, facing(6.0 - 2.0 * k / max(count, 2), (0.5 * k, -0.3 * k, 1.0 * k)))
        for k in range(count)
    ]
    return [",".join(pose_columns("cam_from_target")), *rows]


def every_difference() -> dict[str, Any]:
    """Return a table [told] with every key, each with an offset and a sigma of its own."""
    number = {"offset": 0.001, "sigma": 0.002}
    vector = {"offset": [0.001, -0.002, 0.003], "sigma": 0.002}
    return {
        "camera": dict.fromkeys(("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"), number),
        "optics": {"psf_sigma_px": number},
        "detector": dict.fromkeys(("gain_e_dn", "bias_dn", "read_noise_e"), number),
        "markers": {"place_m": vector, "normal_deg": vector, "radius_m": number},
        "clock": {"offset_s": number, "drift_ppm": number},
        "target": {
            "inertia_scale": number,
            "inertia_axes_deg": vector,
            "centre_of_mass_m": vector,
        },
        "mount": {"turn_deg": vector, "place_m": vector},
    }
