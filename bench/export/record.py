"""The label record: all that formats tell of one image, in numbers that JSON holds.

Lengths are in m, pixels have integer centres, boxes are the least and greatest column and row that
belong to them, masks are run lengths. Each format turns these into its own units and conventions.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np
from pydantic import AfterValidator, ConfigDict, Field, TypeAdapter, ValidationError

from models.arrays import Floats
from models.errors import DatasetError
from models.pose import RigidTransform

CONFIG = ConfigDict(extra="forbid", allow_inf_nan=False)


def _inside(name: str) -> str:
    if not name or Path(name).is_absolute() or ".." in Path(name).parts:
        raise ValueError("expected a path within the export")
    return name


Box = tuple[int, int, int, int]
Three = Annotated[list[float], Field(min_length=3, max_length=3)]
Four = Annotated[list[float], Field(min_length=4, max_length=4)]
Five = Annotated[list[float], Field(min_length=5, max_length=5)]
Nine = Annotated[list[float], Field(min_length=9, max_length=9)]
Point = Annotated[list[float], Field(min_length=2, max_length=2)]
OwnPath = Annotated[str, AfterValidator(_inside)]


@dataclass(frozen=True)
class MaskRecord:
    """A mask within the image, and what of it there is in all.

    Attributes
    ----------
    lengths : list of int
        Run lengths of the part within the image; see ``bench.export.run_lengths``.
    count : int
        Pixels, those beyond the image's edge too.
    box : tuple of 4 int or None, px
        ``x0, y0, x1, y1``, both ends belonging to it; it may leave the image. None if empty.
    """

    lengths: list[int]
    count: int
    box: Box | None
    __pydantic_config__: ClassVar[ConfigDict] = CONFIG


@dataclass(frozen=True)
class Record:
    """What is known of one image.

    Attributes
    ----------
    key, split, stream : str
    scene, frame : int
        Number of the dataset, from 1, and of the frame in it.
    time_s : float, s
        Middle of the exposure.
    exposure_ms : float, ms
    width, height, channels : int
        Of the image; one channel is grey, three are blue, green, red.
    camera : list of 4 float, or None, px
        fx, fy, cx, cy.
    distortion : list of 5 float
        k1, k2, p1, p2, k3.
    object_id : int or None
        The target's number; None where there is no pose.
    rotation : list of 9 float, or None
        ``R_cam_from_target``, row by row.
    translation_m : list of 3 float, or None, m
    sun_dir_in_target : list of 3 float, or None
    keypoints_px : list of (float, float) or None, px
        None behind the lens.
    keypoint_states : list of str
        See ``bench.export.keypoints``.
    full, visible : MaskRecord or None
        The target's silhouette, whatever stands before it; and what of it is seen.
    valid : int
        Pixels of the silhouette within the image that have a depth.
    depth_scale_mm : float, mm
    files : dict of str to (int, str)
        Size and SHA-256 of each file of this image, by its path in the export.
    """

    key: str
    scene: int
    frame: int
    stream: str
    split: str
    time_s: float
    exposure_ms: float
    width: int
    height: int
    channels: int
    camera: Four | None
    distortion: Five
    object_id: int | None
    rotation: Nine | None
    translation_m: Three | None
    sun_dir_in_target: Three | None
    keypoints_px: list[Point | None]
    keypoint_states: list[str]
    full: MaskRecord | None
    visible: MaskRecord | None
    valid: int
    depth_scale_mm: float
    files: dict[OwnPath, tuple[int, str]] = field(default_factory=dict)
    __pydantic_config__: ClassVar[ConfigDict] = CONFIG

    @property
    def cam_from_target(self) -> RigidTransform | None:
        """The true pose."""
        if self.rotation is None or self.translation_m is None:
            return None
        return RigidTransform(np.reshape(self.rotation, (3, 3)), np.array(self.translation_m))

    @property
    def matrix(self) -> list[float] | None:
        """The calibration matrix K, row by row, px."""
        if self.camera is None:
            return None
        fx, fy, cx, cy = self.camera
        return [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]

    @property
    def visible_fraction(self) -> float:
        """The part of the silhouette that is seen, from 0 to 1."""
        if self.full is None or self.visible is None or not self.full.count:
            return 0.0
        return self.visible.count / self.full.count

    @property
    def range_m(self) -> float | None:
        """Distance from the lens to the target's origin, m."""
        if self.translation_m is None:
            return None
        return float(np.linalg.norm(self.translation_m))

    @property
    def camera_dir_in_target(self) -> Floats | None:
        """(3,) unit vector from the target's origin to the lens; None without a pose."""
        pose = self.cam_from_target
        if pose is None:
            return None
        way = pose.inverse().translation
        length = float(np.linalg.norm(way))
        return way / length if length > 0.0 else None

    @property
    def phase_angle_deg(self) -> float | None:
        """Angle at the target between the Sun and the lens, deg."""
        towards = self.camera_dir_in_target
        if towards is None or self.sun_dir_in_target is None:
            return None
        cosine = float(np.clip(towards @ np.array(self.sun_dir_in_target), -1.0, 1.0))
        return float(np.rad2deg(np.arccos(cosine)))

    def with_files(self, files: dict[str, tuple[int, str]]) -> Record:
        """Return it with the files that were written of it."""
        return replace(self, files=files)

    def to_json(self) -> str:
        """Return its text, on one line."""
        return json.dumps(asdict(self)) + "\n"


def record_from_json(text: str, where: object) -> Record:
    """Read a record that an export left beside its files.

    Raises
    ------
    DatasetError
        If it is none.
    """
    try:
        return _RECORD.validate_json(text, strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        what = f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
        raise DatasetError(
            f"{where}: expected a label record, got: {what}; delete it and export again"
        ) from error


_RECORD = TypeAdapter(Record)
