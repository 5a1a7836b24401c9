"""From what is true to what a pipeline is told of it in a run; see ``[told]`` of a scenario.

The sigma of a draw is told with it; an offset is told to nobody.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from models.camera import Camera
from models.dataset.frame_table import FrameEntry
from models.errors import ScenarioError
from models.frame import TableReading
from models.onboard import OnboardKnowledge, needed
from renders.scenario.told_tables import (
    CalibrationTable,
    Difference,
    ToldTable,
    VectorDifference,
)
from renders.world.told_draws import error_of
from renders.world.told_parts import (
    told_camera,
    told_detector,
    told_expectations,
    told_markers,
    told_psf_sigma_px,
    told_wireframe,
)

CALIBRATION_DRAW = 102  # purpose that keys a run's random numbers
MOST_DRIFT = 0.1  # of the true time
FOCAL, CENTRE = ("fx", "fy"), ("cx", "cy")
SAID_OF = {
    "markers.place_m": "markers.point_in_target_m",
    "markers.normal_deg": "markers.normal_in_target_deg",
    "target.inertia_scale": "knowledge.inertia_scale",
    "target.inertia_axes_deg": "knowledge.inertia_axes_deg",
    "target.centre_of_mass_m": "wireframe.centre_of_mass_m",
    "mount.turn_deg": "knowledge.R_cam_from_lvlh_deg",
    "mount.place_m": "knowledge.t_cam_from_lvlh_m",
    "clock.offset_s": "frames.offset_s",
    "clock.drift_ppm": "frames.drift_ppm",
}
"""Files and keys of a dataset that a quantity stands in, where they are named otherwise."""


def told(
    true: OnboardKnowledge, table: ToldTable | None, calibration: CalibrationTable, run: int
) -> OnboardKnowledge:
    """Return what is on board in a run.

    Parameters
    ----------
    true : OnboardKnowledge
        As simulated; its ``psf_sigma_px`` is told only where the table says so.
    table : ToldTable or None
    calibration : CalibrationTable
    run : int

    Raises
    ------
    ScenarioError
        If the run's draw gives something that cannot be.
    """
    camera = calibrated(needed(true.camera, "camera.toml", "a render"), calibration, run)
    detector = needed(true.detector, "detector.toml", "a render")
    onboard = replace(
        true,
        camera=camera,
        expectations=told_expectations(true.expectations, None, None, run),
        psf_sigma_px=None,
    )
    if table is None:
        return onboard
    try:
        return replace(
            onboard,
            camera=told_camera(camera, table.camera, run),
            detector=told_detector(detector, table.detector, run),
            markers=told_markers(true.markers, table.markers, run),
            wireframe=told_wireframe(true.wireframe, table.target, run),
            expectations=told_expectations(true.expectations, table.mount, table.target, run),
            psf_sigma_px=told_psf_sigma_px(true.psf_sigma_px, table.optics, run),
            sigmas={**true.sigmas, **sigmas_told(table, calibration)},
        )
    except (ScenarioError, ValueError) as error:
        raise ScenarioError(
            f"expected told.* and calibration.* under which every run knows something possible; "
            f"in run {run}: {error}; give smaller offsets or sigmas"
        ) from error


def calibrated(camera: Camera, table: CalibrationTable, run: int) -> Camera:
    """Return the camera as a run's ``[calibration]`` has it.

    Parameters
    ----------
    camera : Camera
        As simulated.
    table : CalibrationTable
    run : int
    """
    draw = np.random.default_rng([run, CALIBRATION_DRAW]).standard_normal(4)
    focal, centre = table.sigma_focal_px, table.sigma_principal_point_px
    return replace(
        camera,
        fx=float(camera.fx + focal * draw[0]),
        fy=float(camera.fy + focal * draw[1]),
        cx=float(camera.cx + centre * draw[2]),
        cy=float(camera.cy + centre * draw[3]),
    )


@dataclass(frozen=True)
class ToldClock:
    """The clock on board in a run: what it shows is not quite the time.

    Attributes
    ----------
    offset_s : float, s
    drift : float
        Seconds gained a second.
    """

    offset_s: float = 0.0
    drift: float = 0.0

    @classmethod
    def of(cls, table: ToldTable | None, run: int) -> ToldClock:
        """Return a run's clock.

        Raises
        ------
        ScenarioError
            If it drifts as no clock does.
        """
        if table is None or table.clock is None:
            return cls()
        offset_s = error_of(table.clock.offset_s, run, "clock.offset_s")
        drift = 1e-6 * error_of(table.clock.drift_ppm, run, "clock.drift_ppm")
        if abs(drift) > MOST_DRIFT:
            raise ScenarioError(
                f"expected told.clock.drift_ppm within {1e6 * MOST_DRIFT:g}, got a clock that "
                f"gains {1e6 * drift:g} s in a million in run {run}"
            )
        return cls(offset_s, drift)

    def shows(self, time_s: float) -> float:
        """Return what the clock shows at a true time, s; the same to the bit if it is exact."""
        if self == EXACT_CLOCK:
            return time_s
        return float(time_s + self.offset_s + self.drift * time_s)

    def stamped(self, entry: FrameEntry) -> FrameEntry:
        """Return a frame with the time that the clock shows."""
        return replace(entry, time_s=self.shows(entry.time_s))

    def stamped_rows(self, reading: TableReading) -> TableReading:
        """Return rows with the times that the clock shows."""
        if self == EXACT_CLOCK:
            return reading
        times_s = np.array([self.shows(time_s) for time_s in reading.time_s.tolist()])
        return TableReading(reading.columns, times_s, reading.rows)


EXACT_CLOCK = ToldClock()


def sigmas_told(table: ToldTable, calibration: CalibrationTable) -> dict[str, float]:
    """Return the 1-sigma of every draw, by ``file.key``; what is not drawn is absent."""
    sigmas = dict(_sigmas(table))
    for names, sigma in (
        (FOCAL, calibration.sigma_focal_px),
        (CENTRE, calibration.sigma_principal_point_px),
    ):
        for name in names:
            key = f"camera.{name}"
            sigmas[key] = float(np.hypot(sigmas.get(key, 0.0), sigma))
    return {key: sigma for key, sigma in sigmas.items() if sigma > 0.0}


def _sigmas(table: ToldTable) -> Iterator[tuple[str, float]]:
    for name, key, difference in quantities(table):
        yield SAID_OF.get(f"{name}.{key}", f"{name}.{key}"), difference.sigma


def quantities(table: ToldTable) -> Iterator[tuple[str, str, Difference | VectorDifference]]:
    """Walk the quantities that a table tells otherwise: table, key and difference."""
    for name in type(table).model_fields:
        inner = getattr(table, name)
        for key in () if inner is None else type(inner).model_fields:
            difference = getattr(inner, key)
            if difference is not None:
                yield name, key, difference


def markers_are_told_otherwise(table: ToldTable | None) -> bool:
    """Tell whether the markers on board are others than those that are rendered."""
    return table is not None and table.markers is not None
