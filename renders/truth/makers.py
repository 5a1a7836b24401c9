"""What is sealed of an exposure: of markers, or of a wireframe's landmarks. Mitsuba loads late."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from models.pose import RigidTransform
from models.reading.fields import Fields
from models.wireframe.wireframe import Wireframe
from renders.world.exposure import Exposure
from renders.world.trajectory import FreeMotion

if TYPE_CHECKING:
    from renders.truth.exposure_truth import ExposureTruth
    from renders.truth.image_truth import ImageTruth
    from renders.truth.posed_truth import PosedTruth
    from renders.world.world import World


class SealedRecord(Protocol):
    """One exposure as it was: a line of ``truth/exposures.jsonl``."""

    @property
    def frame(self) -> int:
        """Its frame."""
        ...

    @property
    def band(self) -> int:
        """Its band."""
        ...

    def to_json(self) -> dict[str, Any]:
        """Return the JSON object of its line."""
        ...


class TruthMaker(Protocol):
    """Makes the record of an exposure from the scene in which it was taken."""

    def __call__(
        self, scene: Any, world: World, exposure: Exposure, cam_from_target: RigidTransform, /
    ) -> SealedRecord:
        """Return the record."""
        ...

    def read(self, fields: Fields) -> SealedRecord:
        """Read a record back."""
        ...


class OfMarkers:
    """Makes records of where the target's markers are, and what each gets of light."""

    def __call__(
        self, scene: Any, world: World, exposure: Exposure, cam_from_target: RigidTransform
    ) -> ExposureTruth:
        """Return the record."""
        from renders.truth.marker_truth import exposure_truth

        return exposure_truth(scene, world, exposure, cam_from_target)

    def read(self, fields: Fields) -> ExposureTruth:
        """Read a record back."""
        from renders.truth.exposure_truth import ExposureTruth

        return ExposureTruth.from_fields(fields)


@dataclass(frozen=True, eq=False)
class OfLandmarks:
    """Makes records of where a free target's landmarks are, and how it and the chaser move.

    Attributes
    ----------
    motion : FreeMotion
    wireframe : Wireframe or None
        None where it has none: then there are no landmarks.
    """

    motion: FreeMotion
    wireframe: Wireframe | None

    def __call__(
        self, scene: Any, world: World, exposure: Exposure, cam_from_target: RigidTransform
    ) -> ImageTruth:
        """Return the record."""
        from renders.truth.landmark_truth import image_truth

        return image_truth(
            scene, world, exposure, cam_from_target, motion=self.motion, wireframe=self.wireframe
        )

    def read(self, fields: Fields) -> ImageTruth:
        """Read a record back."""
        from renders.truth.image_truth import ImageTruth

        return ImageTruth.from_fields(fields)


@dataclass(frozen=True, eq=False)
class OfPoses:
    """Makes records of single images at given poses.

    Attributes
    ----------
    wireframe : Wireframe or None
        Whose landmarks are looked for.
    """

    wireframe: Wireframe | None

    def __call__(
        self, scene: Any, world: World, exposure: Exposure, cam_from_target: RigidTransform
    ) -> PosedTruth:
        """Return the record."""
        from renders.truth.landmark_truth import posed_truth

        return posed_truth(scene, world, exposure, cam_from_target, self.wireframe)

    def read(self, fields: Fields) -> PosedTruth:
        """Read a record back."""
        from renders.truth.posed_truth import PosedTruth

        return PosedTruth.from_fields(fields)
