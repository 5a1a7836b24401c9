"""``prior.toml``: the first pose as drawn, with its sigmas."""

from __future__ import annotations

from pathlib import Path

import tomli_w

from models.onboard import PosePrior
from models.pose import RigidTransform, euler_321_from_rotation, rotation_from_euler_321
from models.reading.bounds import ANGLE_DEG, LENGTH_M
from models.reading.fields import Fields
from models.reading.toml_file import read_toml

KEYS = ("t_cam_from_target_m", "euler_321_deg", "sigma_t_m", "sigma_euler_deg")
NEAREST_M = 1e-3
WIDEST_DEG = 180.0


def prior_to_toml(prior: PosePrior) -> str:
    """Return the text of ``prior.toml``."""
    return tomli_w.dumps(
        {
            "t_cam_from_target_m": prior.cam_from_target.translation.tolist(),
            "euler_321_deg": euler_321_from_rotation(prior.cam_from_target.rotation).tolist(),
            "sigma_t_m": prior.sigma_m.tolist(),
            "sigma_euler_deg": prior.sigma_deg.tolist(),
        }
    )


def read_prior(path: Path) -> PosePrior:
    """Read ``prior.toml``.

    Raises
    ------
    DatasetError
        If a key is missing, a value cannot be, or the target is not in front of the camera.
    """
    fields = Fields(read_toml(path), path)
    fields.only(KEYS)
    translation = fields.vector("t_cam_from_target_m", 3, *LENGTH_M)
    if not translation[2] >= NEAREST_M:
        raise fields.refusal(
            "t_cam_from_target_m",
            f"with the target in front of the camera, its third number at least {NEAREST_M} m",
            translation.tolist(),
        )
    angles_deg = fields.vector("euler_321_deg", 3, *ANGLE_DEG)
    return PosePrior(
        cam_from_target=RigidTransform(rotation_from_euler_321(angles_deg), translation),
        sigma_m=fields.vector("sigma_t_m", 3, 0.0, LENGTH_M[1]),
        sigma_deg=fields.vector("sigma_euler_deg", 3, 0.0, WIDEST_DEG),
    )
