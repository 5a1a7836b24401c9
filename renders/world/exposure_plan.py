"""Which exposure times are known before any image: planned, typed, or the first of a meter's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from models.dataset.frame_table import FrameEntry
from models.errors import ScenarioError
from models.motion.table_motion import TableMotion
from models.onboard import PosePrior
from models.sensors.auto_exposure import AutoExposure
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.detector.expose import electrons_per_radiance
from renders.scenario.camera_tables import ExposureTable
from renders.scenario.scenario import Scenario
from renders.world.trajectory import Trajectory


class Planned(Protocol):
    """A plan of exposure times made before flight."""

    def __call__(self, time_s: float, prior: PosePrior | None, /) -> float:
        """Return the exposure time at an instant, ms."""
        ...


@dataclass(frozen=True, eq=False)
class FillOfMarkers:
    """As the square of the range by the prior, so that a marker on the boresight fills its share.

    The range is the flight plan's, shifted by how far off the first prior had it.

    Attributes
    ----------
    scenario : Scenario
    flight_plan : Trajectory
        The motion that the chaser reckons with.
    optics : RetroreflectorOptics
    """

    scenario: Scenario
    flight_plan: Trajectory
    optics: RetroreflectorOptics

    def __call__(self, time_s: float, prior: PosePrior | None) -> float:
        """Return the exposure time at an instant, ms."""
        if prior is None:
            raise ScenarioError(
                f"{self.scenario.name}: expected exposure.mode as auto or fixed where no prior "
                "is known on board, got 'schedule'"
            )
        scenario, start_s = self.scenario, self.scenario.motion.start_s
        planned = self.flight_plan.cam_from_target(time_s).translation[2]
        first = prior.cam_from_target.translation[2]
        offset = first - self.flight_plan.cam_from_target(start_s).translation[2]
        range_m = max(planned + offset, 0.1)
        lobe = np.pi * np.sin(np.deg2rad(self.optics.half_angle_deg)) ** 2
        radiance = self.optics.returned.nir850 / lobe
        radiance *= scenario.lamps.intensity_w_sr / range_m**2
        detector = scenario.simulated_detector
        rate = radiance * electrons_per_radiance(scenario.simulated_optics, detector, 850.0)
        return float(1e3 * scenario.exposure.marker_fill * detector.full_well_e / rate)


@dataclass(frozen=True, eq=False)
class TypedSchedule:
    """Linear between typed instants; before the first and after the last, as there.

    Attributes
    ----------
    times_s, exposures_ms : (n,) tuples of float, s and ms
    """

    times_s: tuple[float, ...]
    exposures_ms: tuple[float, ...]

    def __call__(self, time_s: float, prior: PosePrior | None) -> float:
        """Return the exposure time at an instant, ms."""
        return float(np.interp(time_s, self.times_s, self.exposures_ms))


@dataclass(frozen=True, eq=False)
class OfTable:
    """As the rows of a table of poses have it.

    Attributes
    ----------
    motion : TableMotion
    share : float
        How much of it is meant; see ``ExposurePlan``.
    """

    motion: TableMotion
    share: float

    def __call__(self, time_s: float, prior: PosePrior | None) -> float:
        """Return the exposure time at an instant, ms."""
        return self.share * self.motion.exposure_ms(time_s)


@dataclass(frozen=True, eq=False)
class ExposurePlan:
    """The exposure times of a scenario.

    Attributes
    ----------
    table : ExposureTable
    planned : Planned
        With ``mode = "schedule"`` or ``"table"``.
    share : float
        How much of a typed exposure time, or of a bound on it, is meant. It is typed for the
        chip's own pixels: larger ones, with ``--width``, fill sooner and are exposed for less, so
        that a first look shows the same levels.
    """

    table: ExposureTable
    planned: Planned
    share: float = 1.0

    @property
    def metered(self) -> bool:
        """Whether each frame's exposure time follows from the image before it."""
        return self.table.mode == "auto"

    @property
    def meter(self) -> AutoExposure:
        """How an exposure time follows from an image."""
        return AutoExposure(
            percentile=self.table.percentile,
            fill=self.table.percentile_fill,
            max_step=self.table.max_step,
            min_ms=self.table.min_ms * self.share,
            max_ms=self.table.max_ms * self.share,
        )

    def before_any_image(self, time_s: float, prior: PosePrior | None) -> float:
        """Return the exposure time at an instant, ms; where it is metered, the first frame's."""
        if self.table.mode in ("schedule", "table"):
            return self.planned(time_s, prior)
        return self.table.exposure_ms * self.share

    def entries(self, times_s: Sequence[float], prior: PosePrior | None) -> list[FrameEntry]:
        """Return the rows of ``frames.csv`` that are known before any image.

        All of them, unless each exposure is metered from the image before: then the first alone
        (see ``renders.detector.exposure_control``).
        """
        known = times_s[:1] if self.metered else times_s
        return [
            FrameEntry(frame, time_s, self.before_any_image(time_s, prior))
            for frame, time_s in enumerate(known)
        ]
