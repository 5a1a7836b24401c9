"""The silhouettes of a run, each from where the end of the run knows the target to have been."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from models.arrays import Labels
from models.estimate import Estimate
from models.frame import IMAGE, Frame
from pipelines.detection.target_region import find_target
from pipelines.unknown_target.carved_surface import View
from pipelines.unknown_target.knowledge import UnknownTargetKnowledge, mean_motion_of
from pipelines.unknown_target.options import BatchOptions
from pipelines.unknown_target.outline_rows import (
    Outlines,
    doubted_outlines,
    outline_rows,
    pairs_of,
)
from pipelines.unknown_target.past_poses import KnownMotion
from pipelines.unknown_target.silhouettes import silhouette


def views_of_run(
    said: Estimate,
    frames: Iterable[Frame],
    knowledge: UnknownTargetKnowledge,
    went_on: Callable[[], None] = lambda: None,
) -> list[View]:
    """Return the silhouettes that carve; those that most others doubt are left out.

    Parameters
    ----------
    said : Estimate
        The last with a pose.
    frames : iterable of Frame
        Not after it.
    knowledge : UnknownTargetKnowledge
    went_on : callable
        Told after each frame.

    Returns
    -------
    list of View
        None of a frame that shows no target.

    Raises
    ------
    DatasetError
        If the estimate lacks its motion or inertia, or a frame its orbit.
    """
    camera, options = knowledge.camera, BatchOptions()
    covered: list[Labels] = []
    times_s: list[float] = []
    mean_motion = 0.0
    outlines = Outlines(camera)
    for frame in frames:
        mean_motion = mean_motion_of(frame)
        region = find_target(frame.image(IMAGE).image, knowledge.detector)
        if region:
            outline = silhouette(region)
            outlines.add(len(covered), outline)
            covered.append(np.packbits(outline, axis=1))
            times_s.append(frame.time_s)
        went_on()
    if not covered:
        return []
    known = KnownMotion.of(said, knowledge.cam_from_lvlh.rotation, mean_motion)
    where = known.at(np.array(times_s))
    pairs = pairs_of(where)
    rows = outline_rows(where, outlines, pairs, options.outline_px / camera.fx)
    doubted = doubted_outlines(outlines, pairs, rows, options.gate_sigmas)
    return [
        View(
            where.R_cam_from_target[place],
            where.t_cam_from_target[place],
            np.unpackbits(covered[place], axis=1, count=camera.width).astype(bool),
        )
        for place in range(len(covered))
        if place not in doubted
    ]
