"""The scenario's tables of what a pipeline is told, where that differs from what is simulated.

Every quantity may differ by a stated ``offset``, of which the pipeline knows nothing, and by a draw
of 1-sigma ``sigma``, anew in every run, whose sigma it is told (``sigmas.toml``). See
``renders.world.told``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from models.errors import ScenarioError
from renders.scenario.table import Table, Triple

if TYPE_CHECKING:
    from renders.scenario.scenario import Scenario

SigmaM = Annotated[float, Field(ge=0, le=1000)]
SigmaDeg = Annotated[float, Field(ge=0, le=180)]


class PriorTable(Table):
    """1-sigma of the first pose, Opromolla 2022 Table 5."""

    by: Literal["arm"] | None = Field(
        None,
        description="drawn about the true one; arm: drawn so for the camera fixed to the chaser, "
        "and chained with the arm's joints as read to that of the camera in its hand",
    )

    sigma_t_m: Annotated[tuple[SigmaM, SigmaM, SigmaM], Field(strict=False)] = Field(
        (0.017, 0.017, 0.05), description="translation, camera axes"
    )
    sigma_euler_deg: Annotated[tuple[SigmaDeg, SigmaDeg, SigmaDeg], Field(strict=False)] = Field(
        (1.0, 1.0, 1.0), description="alpha, beta, gamma"
    )


class CalibrationTable(Table):
    """1-sigma of the calibrated camera against the simulated one; zero is exact."""

    sigma_focal_px: float = Field(0.0, ge=0, le=100, description="of fx and of fy, each its own")
    sigma_principal_point_px: float = Field(0.0, ge=0, le=100, description="of cx and of cy")


class Difference(Table):
    """How one number that is told differs from the simulated one."""

    offset: float = Field(0.0, ge=-1e6, le=1e6, description="told minus simulated")
    sigma: float = Field(0.0, ge=0, le=1e6, description="1-sigma of a draw in every run")


class VectorDifference(Table):
    """How a vector that is told differs from the simulated one."""

    offset: Triple = Field((0.0, 0.0, 0.0), description="told minus simulated, along each axis")
    sigma: float = Field(0.0, ge=0, le=1e3, description="1-sigma of a draw, per axis, in every run")


class ToldCameraTable(Table):
    """The camera as calibrated, in pixels of the rendered image; beside ``[calibration]``."""

    fx: Difference | None = Field(None, description="focal length across, px")
    fy: Difference | None = Field(None, description="focal length down, px")
    cx: Difference | None = Field(None, description="principal point, px")
    cy: Difference | None = Field(None, description="principal point, px")
    k1: Difference | None = Field(None, description="distortion")
    k2: Difference | None = Field(None, description="distortion")
    p1: Difference | None = Field(None, description="distortion")
    p2: Difference | None = Field(None, description="distortion")
    k3: Difference | None = Field(None, description="distortion")


class ToldOpticsTable(Table):
    """The lens as measured."""

    psf_sigma_px: Difference = Field(
        Difference(),  # type: ignore[call-arg]
        description="blur, px of the rendered image; told where this table is",
    )


class ToldDetectorTable(Table):
    """The detector as calibrated."""

    gain_e_dn: Difference | None = Field(None, description="e/DN")
    bias_dn: Difference | None = Field(None, description="DN")
    read_noise_e: Difference | None = Field(None, description="e")


class ToldMarkersTable(Table):
    """The markers as surveyed; ``offset`` is that of all, a draw that of each."""

    place_m: VectorDifference | None = Field(None, description="centres, target axes, m")
    normal_deg: VectorDifference | None = Field(
        None, description="a small turn of the normals about the target's axes, deg"
    )
    radius_m: Difference | None = Field(None, description="radius of every disc, m")


class ToldClockTable(Table):
    """The clock on board: its time is the true one, plus offset, plus drift times the true one."""

    offset_s: Difference | None = Field(None, description="s")
    drift_ppm: Difference | None = Field(None, description="of the true time, 1e-6")


class ToldTargetTable(Table):
    """The free target's mass properties as known."""

    inertia_scale: Difference | None = Field(
        None, description="relative: 0.1 tells moments 10 % too large"
    )
    inertia_axes_deg: VectorDifference | None = Field(
        None, description="a small turn of the inertia about the target's axes, deg"
    )
    centre_of_mass_m: VectorDifference | None = Field(
        None, description="in the drawing, target axes, m: the drawing is told about it"
    )


class ToldMountTable(Table):
    """The camera's mount on the chaser as measured, of ``cam_from_lvlh``."""

    turn_deg: VectorDifference | None = Field(
        None, description="a small turn about the camera's axes, deg"
    )
    place_m: VectorDifference | None = Field(None, description="camera axes, m")


class ToldArmTable(Table):
    """The arm as read and measured; see ``models.arm.onboard_arm``."""

    joints_deg: Difference | None = Field(
        None, description="what each joint reads, deg: one offset, a draw of its own for each"
    )
    mount_turn_deg: VectorDifference | None = Field(
        None, description="a small turn of the hand camera about its axes, deg"
    )
    mount_place_m: VectorDifference | None = Field(
        None, description="end effector in the hand camera's axes, m"
    )


class ToldTable(Table):
    """What a pipeline is told otherwise than it is simulated; what is left out is told as it is.

    The sigmas of ``[calibration]`` are told too, where this table is.
    """

    camera: ToldCameraTable | None = Field(None, description="as calibrated")
    optics: ToldOpticsTable | None = Field(None, description="as measured")
    detector: ToldDetectorTable | None = Field(None, description="as calibrated")
    markers: ToldMarkersTable | None = Field(None, description="as surveyed")
    clock: ToldClockTable | None = Field(None, description="on board")
    target: ToldTargetTable | None = Field(None, description="mass properties")
    mount: ToldMountTable | None = Field(None, description="of the camera")
    arm: ToldArmTable | None = Field(None, description="as read and measured")


OF_PAIRS, OF_TUMBLE = ("markers",), ("target", "mount")


def check_told(scenario: Scenario, where: str) -> None:
    """Refuse to tell otherwise what nobody is told at all.

    Raises
    ------
    ScenarioError
        The message names the table.
    """
    if scenario.told is None:
        return
    told_of = dict.fromkeys(OF_PAIRS, scenario.frame_kind in ("pairs", "colour"))
    told_of |= dict.fromkeys(OF_TUMBLE, scenario.motion_kind == "tumble")
    for name, is_told in told_of.items():
        if getattr(scenario.told, name) is not None and not is_told:
            what = "image pairs of markers" if name in OF_PAIRS else "[tumble]"
            raise ScenarioError(
                f"{where}: expected told.{name} to be left out without {what}, where no pipeline "
                "is told of it"
            )
    if scenario.told.arm is not None and scenario.arm is None:
        raise ScenarioError(
            f"{where}: expected told.arm to be left out without [arm], where no pipeline is told "
            "of it"
        )
    target, tumble = scenario.told.target, scenario.tumble
    if target is not None and tumble is not None and not tumble.onboard.knows_inertia:
        for key in ("inertia_scale", "inertia_axes_deg"):
            if getattr(target, key) is not None:
                raise ScenarioError(
                    f"{where}: expected told.target.{key} to be left out where "
                    "tumble.onboard.knows_inertia is false, got one"
                )
