"""What is loaded on board before the first frame: as calibrated, as surveyed, as drawn.

Never as simulated: every part may differ from what is true. A pipeline takes the parts that it
needs and says which it lacks; the files are those of a dataset's public half.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, TypeVar

from models.arrays import Floats
from models.camera import Camera
from models.errors import DatasetError
from models.markers import MarkerPattern
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from models.wireframe.wireframe import Wireframe

Part = TypeVar("Part")

HOW_TO_GIVE = {
    "prior.toml": "it tracks from a first pose: write t_cam_from_target_m, euler_321_deg, "
    "sigma_t_m and sigma_euler_deg, three numbers each",
    "markers.toml": "name a target that has markers, or a markers.toml",
    "wireframe.json": "name a target that has a wireframe, or a wireframe.json",
    "knowledge.toml": "write how the camera is mounted, R_cam_from_lvlh (3 x 3) and "
    "t_cam_from_lvlh_m, and the 1-sigmas sigma_px, chaser_sigma_m and chaser_sigma_m_s",
    "absolute.toml": "write regime (leo or geo), epoch, and position_m, velocity_m_s and "
    "q_inertial_from_body_wxyz at time zero",
}
"""What to write into a file that a pipeline lacks."""


@dataclass(frozen=True, eq=False)
class PosePrior:
    """The first pose, as drawn.

    Attributes
    ----------
    cam_from_target : RigidTransform
        At the first frame.
    sigma_m : (3,) array, m
    sigma_deg : (3,) array, deg
        1-sigma in translation and in (alpha, beta, gamma).
    """

    cam_from_target: RigidTransform
    sigma_m: Floats
    sigma_deg: Floats


@dataclass(frozen=True, eq=False)
class FlightExpectations:
    """How the camera is mounted, and what was expected before flight of a free target.

    Attributes
    ----------
    cam_from_lvlh : RigidTransform
        The mount: the chaser's body frame is its local frame.
    sigma_px : float, px
        1-sigma of a corner, per axis.
    chaser_sigma_m, chaser_sigma_m_s : float, m and m/s
        1-sigma per axis of the chaser's absolute navigation.
    range_m : (float, float) or None, m
        A coarse range, nearest and farthest.
    inertia_kg_m2 : (3, 3) array or None
        Of the target about its centre of mass, target axes; any multiple serves.
    sun_dir_in_inertial : (3,) array or None
        Unit vector towards the Sun by the ephemeris on board, in the axes of the chaser's orbit.
    sun_sigma_deg : float, deg
        1-sigma per axis of that direction as the camera sees it: the ephemeris is nearly exact,
        the chaser's own attitude is not.
    earth_shines : bool
        Whether the Earth lights the target; it stands where the chaser's orbit has it,
    earth_dir_in_inertial : (3,) array or None
        unless this is known, a unit vector towards its centre.
    white_dn_ms : float or None, DN/ms
        What a white matt surface that the Sun meets squarely gives the camera, as calibrated.
    earth_hides_sun : bool
        Whether the Sun goes out where the chaser's orbit has the Earth before it.
    """

    cam_from_lvlh: RigidTransform
    sigma_px: float
    chaser_sigma_m: float = 0.0
    chaser_sigma_m_s: float = 0.0
    range_m: tuple[float, float] | None = None
    inertia_kg_m2: Floats | None = None
    sun_dir_in_inertial: Floats | None = None
    sun_sigma_deg: float = 0.0
    earth_shines: bool = False
    earth_dir_in_inertial: Floats | None = None
    white_dn_ms: float | None = None
    earth_hides_sun: bool = False


@dataclass(frozen=True, eq=False)
class OnboardKnowledge:
    """All that is on board; what is None is not.

    Attributes
    ----------
    camera : Camera or None
    detector : Detector or None
    markers : MarkerPattern or None
    prior : PosePrior or None
    wireframe : Wireframe or None
    expectations : FlightExpectations or None
    psf_sigma_px : float or None, px
        Blur of the lens as measured before flight.
    sigmas : dict of str to float
        1-sigma of what the above may be wrong by, by ``file.key``: ``camera.fx``.
    tables : dict of str to dict
        What else a chain has on board, such as a range finder's calibration: tables of TOML, by
        the name of their file.
    """

    camera: Camera | None = None
    detector: Detector | None = None
    markers: MarkerPattern | None = None
    prior: PosePrior | None = None
    wireframe: Wireframe | None = None
    expectations: FlightExpectations | None = None
    psf_sigma_px: float | None = None
    sigmas: dict[str, float] = field(default_factory=dict)
    tables: dict[str, dict[str, Any]] = field(default_factory=dict)


def needed(part: Part | None, file: str, pipeline: str) -> Part:
    """Return a part of what is on board.

    Parameters
    ----------
    part : object or None
    file : str
        Where a dataset has it.
    pipeline : str
        Who needs it.

    Raises
    ------
    DatasetError
        If it is not on board.
    """
    if part is None:
        told = HOW_TO_GIVE.get(file)
        raise DatasetError(
            f"expected {file} for the pipeline {pipeline}, got none" + (f"; {told}" if told else "")
        )
    return part
