"""What lens, chip and particles must be together for a picture that can be reckoned."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.errors import ScenarioError
from renders.scenario.motion_choice import table_motion_of

if TYPE_CHECKING:
    from renders.scenario.scenario import Scenario

MOST_HITS = 1e6  # particles in one exposure; each is drawn on its own
NEAREST_FOCI = 2.0  # focal lengths: at less a lens magnifies, and is no camera's


def check_picture(scenario: Scenario, where: str) -> None:
    """Refuse a focus within the lens, and more particles than can be drawn.

    Raises
    ------
    ScenarioError
        The message names the keys.
    """
    camera, detector = scenario.simulated_camera, scenario.simulated_detector
    focal_m = camera.fx * detector.pixel_pitch_um * 1e-6
    focus_m = scenario.optics.focus_m
    if 0.0 < focus_m <= NEAREST_FOCI * focal_m:
        raise ScenarioError(
            f"{where}: expected optics.focus_m beyond twice the focal length, which is "
            f"{focal_m:.3g} m with pixels of detector.pixel_pitch_um, got {focus_m:g} m"
        )
    side_cm = detector.pixel_pitch_um * 1e-4
    chip_cm2 = camera.width * camera.height * side_cm**2
    longest_ms, flux = _longest_ms(scenario), scenario.radiation.flux_cm2_s
    hits = flux * chip_cm2 * longest_ms * 1e-3
    if hits > MOST_HITS:
        raise ScenarioError(
            f"{where}: expected radiation.flux_cm2_s of at most {flux * MOST_HITS / hits:.3g}, "
            f"{MOST_HITS:g} particles on the chip of {chip_cm2:.3g} cm2 in an exposure of up to "
            f"{longest_ms:g} ms, got {flux:g}"
        )


def _longest_ms(scenario: Scenario) -> float:
    """Return the longest that an exposure may be, ms; on schedule none lasts into the next."""
    table = scenario.exposure
    if table.mode == "table":
        motion = table_motion_of(scenario)
        return max(motion.exposure_ms(time_s) for time_s in scenario.times_s)
    known = {"fixed": table.exposure_ms, "auto": table.max_ms}
    return known.get(table.mode, scenario.motion.pair_gap_ms)
