"""The tables of a specification of a random dataset; ``rvbench new dataset`` writes one."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from models.lights.earth import ALBEDO, EARTH_RADIUS_KM, GEO_RADIUS_KM
from models.spacecraft.catalogue import TARGETS
from renders.scenario.camera_tables import (
    CameraTable,
    DetectorTable,
    LensScatterTable,
    OpticsTable,
    RadiationTable,
)
from renders.scenario.light_tables import FloodlightTable
from renders.scenario.scenario import RenderTable
from renders.scenario.table import Name, Table, Triple

MOST_FRAMES = 1_000_000
RangeM = Annotated[float, Field(ge=0.1, le=1e6)]
RangesM = Annotated[tuple[RangeM, RangeM], Field(strict=False)]
PhaseDeg = Annotated[float, Field(ge=0, le=180)]
ExposureMs = Annotated[float, Field(ge=1e-4, le=1e5)]
SigmaPx = Annotated[float, Field(ge=0, le=50)]
Seed = Annotated[int, Field(ge=0, le=2**63 - 1)]
MOST_FOLDER_NAME = 32  # characters
FolderName = Annotated[
    str, Field(pattern=rf"^[A-Za-z0-9][A-Za-z0-9_.-]{{0,{MOST_FOLDER_NAME - 1}}}$")
]


class TargetTable(Table):
    """One of the spacecraft that are shown, as often as any other."""

    spacecraft: Name = Field(
        description=f"{', '.join(TARGETS)}, or a .toml file of a spacecraft of your own"
    )
    range_m: RangesM | None = Field(
        None, description="nearest and farthest; pose.range_m where left out"
    )
    aim_m: Triple | None = Field(
        None,
        description="what ranges are from and the camera looks at, target axes; the middle of its "
        "bounding box where left out",
    )


class SpecCameraTable(CameraTable):
    """One of the cameras that look, as often as any other: a preset, a file, or one typed here."""

    name: FolderName = Field("camera", description="letters, digits, _, . and -; it names folders")
    range_factor: float = Field(
        1.0, ge=1e-3, le=1e3, description="on the ranges, for a camera of another field of view"
    )
    optics: OpticsTable | None = Field(None, description="its lens, where not [optics]")
    detector: DetectorTable | None = Field(None, description="its chip, where not [detector]")


class PoseTable(Table):
    """How poses are drawn."""

    attitude: Literal["uniform", "approach"] = Field(
        "uniform",
        description="uniform on SO(3), or the camera within a cone about an axis of the target",
    )
    axis: Triple = Field(
        (0.0, 0.0, 1.0), description="approach: from the target to the cone's middle, target axes"
    )
    cone_deg: float = Field(
        20.0, ge=0, le=180, description="approach: half angle, filled evenly by solid angle"
    )
    roll_deg: float = Field(
        180.0, ge=0, le=180, description="approach: most that the camera rolls either way"
    )
    range_m: RangesM = Field((20.0, 60.0), description="nearest and farthest; log-uniform")
    off_axis: float = Field(
        0.5,
        ge=0,
        le=3,
        description="how far from the image's middle the aim may lie, its edge being 1; uniform",
    )
    in_view: Literal["some", "middle", "whole"] = Field(
        "middle",
        description="what of the target must be in the image; other draws are refused and counted",
    )


class SunsTable(Table):
    """How Suns are drawn."""

    by: Literal["phase", "direction"] = Field(
        "phase",
        description="uniform in phase angle (Sun, target, camera), or in direction on the sphere",
    )
    phase_deg: Annotated[tuple[PhaseDeg, PhaseDeg], Field(strict=False)] = Field(
        (0.0, 100.0), description="phase: least and most; other Suns are never drawn"
    )


class ExposuresTable(Table):
    """How exposure times are drawn."""

    exposure_ms: Annotated[tuple[ExposureMs, ExposureMs], Field(strict=False)] = Field(
        (1.0, 8.0), description="shortest and longest; log-uniform"
    )


class BackgroundTable(Table):
    """What stands behind the target: shares of the poses, which are taken in proportion."""

    space: float = Field(1.0, ge=0, le=1e6, description="black")
    stars: float = Field(0.0, ge=0, le=1e6, description="seen where the exposure is long enough")
    earth: float = Field(0.0, ge=0, le=1e6, description="in the image, lit by the same Sun")
    earth_distance_km: float = Field(
        GEO_RADIUS_KM, gt=EARTH_RADIUS_KM, le=1e6, description="from its centre to the target"
    )
    earth_albedo: float = Field(ALBEDO, ge=0, le=1, description="share of sunlight it returns")


class VaryTable(Table):
    """How specimens differ: each has surfaces and a lens of its own."""

    specimens: int = Field(
        1, ge=1, le=1000, description="of each target and camera; each is a folder"
    )
    diffuse: float = Field(
        0.0, ge=0, le=1, description="1-sigma of the logarithm of a material's Lambertian part"
    )
    specular: float = Field(0.0, ge=0, le=1, description="likewise of its mirror part")
    roughness: float = Field(0.0, ge=0, le=1, description="likewise of its roughness")
    psf_sigma_px: Annotated[tuple[SigmaPx, SigmaPx], Field(strict=False)] | None = Field(
        None,
        description="least and most blur of a lens, on the chip's own pixel, uniform; "
        "optics.psf_sigma_px where left out",
    )


class SplitTable(Table):
    """Which poses are for training, validation and testing: all frames of a pose go together."""

    train: float = Field(0.8, ge=0, le=1, description="share of the poses")
    val: float = Field(0.1, ge=0, le=1, description="share of the poses")
    test: float = Field(0.1, ge=0, le=1, description="share of the poses")
    seed: Seed = Field(0, description="of the split alone; frames do not depend on it")


class Spec(Table):
    """A random dataset: what is drawn, from where to where, and by which seed."""

    name: FolderName = Field(description="of the dataset")
    frames: int = Field(ge=1, le=MOST_FRAMES, description="images; of pairs, pairs")
    seed: Seed = Field(1, description="of everything that is drawn but the split")
    suns_per_pose: int = Field(
        5, ge=1, le=1000, description="frames with other Suns at a pose; they cost little"
    )
    exposures_per_sun: int = Field(
        1, ge=1, le=1000, description="frames with other exposure times; they cost no light at all"
    )
    images: Literal["single", "pairs"] = Field(
        "single", description="pairs: at 800 and 850 nm, lit by the lamps; of targets with markers"
    )
    target: Annotated[
        tuple[TargetTable, ...], Field(strict=False, min_length=1, max_length=100)
    ] = Field(description="a table [[target]] for each spacecraft")
    camera: Annotated[
        tuple[SpecCameraTable, ...], Field(strict=False, min_length=1, max_length=100)
    ] = Field(
        (SpecCameraTable(),),  # type: ignore[call-arg]
        description="a table [[camera]] for each",
    )
    pose: PoseTable = PoseTable()  # type: ignore[call-arg]
    sun: SunsTable = SunsTable()  # type: ignore[call-arg]
    exposure: ExposuresTable = ExposuresTable()  # type: ignore[call-arg]
    background: BackgroundTable = BackgroundTable()  # type: ignore[call-arg]
    vary: VaryTable = VaryTable()  # type: ignore[call-arg]
    split: SplitTable = SplitTable()  # type: ignore[call-arg]
    render: RenderTable = RenderTable()  # type: ignore[call-arg]
    optics: OpticsTable = OpticsTable()  # type: ignore[call-arg]
    detector: DetectorTable = DetectorTable()  # type: ignore[call-arg]
    lens_scatter: LensScatterTable = LensScatterTable()  # type: ignore[call-arg]
    radiation: RadiationTable = RadiationTable()  # type: ignore[call-arg]
    floodlight: FloodlightTable = FloodlightTable()  # type: ignore[call-arg]

    @property
    def frames_per_pose(self) -> int:
        """Frames with one pose: every Sun with every exposure."""
        return self.suns_per_pose * self.exposures_per_sun

    @property
    def poses(self) -> int:
        """How many poses there are; the last may have fewer frames."""
        return -(-self.frames // self.frames_per_pose)
