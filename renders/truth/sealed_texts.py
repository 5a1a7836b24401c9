"""What lies behind the wall beside the exposures, as texts: known before any is rendered."""

from __future__ import annotations

from renders.truth.arm_truth import ARM_TRUTH, arm_truth_lines
from renders.truth.range_truth import RANGE_TRUTH, range_truth_text
from renders.world.range_readings import RangeReadings
from renders.world.world import World


def sealed_texts(world: World) -> dict[str, str]:
    """Return the texts of a world's other truth, by file: of its arm, and of its range finder."""
    texts = {}
    arm = arm_truth_lines(world)
    if arm is not None:
        texts[ARM_TRUTH] = arm
    times_s = world.scenario.times_s
    for sensor in world.tables:
        if isinstance(sensor, RangeReadings):
            met = ((frame, sensor.truth(time_s)) for frame, time_s in enumerate(times_s))
            texts[RANGE_TRUTH] = range_truth_text(met)
    return texts
