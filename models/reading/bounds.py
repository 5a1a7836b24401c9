"""What is possible at all: the widest ranges, for numbers of which a reader knows no better.

Each is (lowest, highest), both allowed, so that ``fields.number("time_s", *TIME_S)`` reads well.
Inside them all arithmetic of the house stays finite; outside them no spacecraft has been.
"""

from __future__ import annotations

Bounds = tuple[float, float]

TIME_S: Bounds = (-1e9, 1e9)  # 30 years
EXPOSURE_MS: Bounds = (1e-6, 1e6)
SECONDS: Bounds = (0.0, 1e9)  # a duration
LENGTH_M: Bounds = (-1e6, 1e6)  # within a spacecraft, or between two that see each other
ORBIT_M: Bounds = (-1e9, 1e9)  # the Moon is at 4e8
SPEED_M_S: Bounds = (-1e5, 1e5)
ANGLE_DEG: Bounds = (-36_000.0, 36_000.0)  # a hundred turns
RATE_RAD_S: Bounds = (-1e3, 1e3)
POINT_PX: Bounds = (-1e6, 1e6)  # of a corner seen askance, far out of the image
SIGMA_PX: Bounds = (0.0, 1e6)
UNIT: Bounds = (0.0, 1.0)

MOST_FRAMES = 1_000_000
FRAME: tuple[int, int] = (0, 10_000_000)  # an index; frames may be left out
IMAGE_SIDE_PX: tuple[int, int] = (1, 65_535)

MOST_NAME = 200  # characters
MOST_PROSE = 10_000
