"""The kindest and the harshest directions of a sweep, at full size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bench.report.numbers import number
from bench.sweep.run import SweepResult
from bench.sweep.shots import encoded_png, images_of, picture
from bench.sweep.table import Row, Setting, setting_of
from models.atomic_file import write_bytes
from models.onboard import needed

OF_EACH = 3


@dataclass(frozen=True, eq=False)
class Extreme:
    """One direction of the extremes.

    Attributes
    ----------
    name : str
        ``best_1`` to ``harshest_3``.
    row : Row
    picture : (height, width) uint8 array
        Its last image.
    """

    name: str
    row: Row
    picture: NDArray[np.uint8]

    @property
    def title(self) -> str:
        """Return its rank and Sun."""
        rank = self.name.replace("_", " ").replace("best", "kindest").capitalize()
        return (
            f"{rank} · Sun at azimuth {self.row.azimuth_deg:.4g}, elevation "
            f"{self.row.elevation_deg:.4g} deg"
        )

    @property
    def verdict(self) -> str:
        """Return what the pipeline made of it."""
        return told(self.row)


def told(row: Row) -> str:
    """Return what came of a row, in a line: over its draws where there are several."""
    if row.draws > 1:
        return _told_of_draws(row)
    markers = f"{row.found} of {row.expected} markers or landmarks"
    if row.position_error_mm is None:
        return f"no pose: {row.reason}; {markers} found"
    return (
        f"{markers} found, position expected within {number(row.position_sigma_mm)} mm (1-sigma), "
        f"in this draw off by {number(row.position_error_mm)} mm, attitude by "
        f"{number(row.attitude_error_deg)} deg"
    )


def _told_of_draws(row: Row) -> str:
    words = [f"{number(row.draws_found / row.draws)} of {row.expected} markers or landmarks found"]
    if row.position_rms_mm is not None:
        words.append(
            f"position off by {number(row.position_rms_mm)} mm rms "
            f"({number(row.position_least_mm)} to {number(row.position_most_mm)}), attitude by "
            f"{number(row.attitude_rms_deg)} deg"
        )
    for count, what in ((row.draws_without_pose, "no pose"), (row.draws_wrong, "a wrong pose")):
        if count:
            words.insert(0, f"{what} in {count} of {row.draws} draws")
    if row.reason:
        words.append(f"the first: {row.reason}")
    return f"{row.draws} draws: {'; '.join(words)}"


def ranked(rows: Sequence[Row]) -> tuple[list[Row], list[Row]]:
    """Return the kindest directions, best first, and the harshest, worst first; no row twice.

    See ``Row.harshness``.
    """
    ordered = sorted(rows, key=lambda row: row.harshness)
    each = min(OF_EACH, len(ordered) // 2) or len(ordered)
    return ordered[:each], ordered[::-1][: min(each, len(ordered) - each)]


def extremes(result: SweepResult, setting: Setting) -> list[Extreme]:
    """Expose the extremes of one setting again, by the pipeline that the maps show."""
    rows = [
        row
        for row in result.rows
        if setting_of(row) == setting and row.pipeline == result.map_pipeline
    ]
    best, harshest = ranked(rows)
    named = [("best", best), ("harshest", harshest)]
    return [
        Extreme(f"{name}_{place}", row, _picture(result, setting, row))
        for name, chosen in named
        for place, row in enumerate(chosen, start=1)
    ]


def write_extremes(out: Path, found: Sequence[Extreme]) -> list[Path]:
    """Write the pictures as PNGs into ``out/extremes``; return their paths."""
    paths = []
    for extreme in found:
        path = out / "extremes" / f"{extreme.name}.png"
        write_bytes(path, encoded_png(extreme.picture))
        paths.append(path)
    return paths


def _picture(result: SweepResult, setting: Setting, row: Row) -> NDArray[np.uint8]:
    detector = needed(result.onboard[setting.time_s].detector, "detector.toml", "a sweep")
    images = images_of(result.frame(setting, row.sun_text))
    return picture(list(images.values())[-1], detector)
