"""A dozen frames of a study: found, refused and wrong, with what was true and what was claimed."""

from __future__ import annotations

import numpy as np

from bench.pictures.wireframe_overlay import (
    ESTIMATE_GREEN,
    TRUTH_CYAN,
    Canvas,
    window_around,
)
from bench.report.filmstrip import MOST_FRAMES, Picture, jpeg
from bench.report.numbers import number
from bench.suites.uncooperative_suns.cases import SUNS, draw_motion
from bench.suites.uncooperative_suns.frames import known_of
from bench.suites.uncooperative_suns.plan import Plan
from bench.suites.uncooperative_suns.results import Starts
from bench.suites.units import done_outcome
from models.onboard import OnboardKnowledge
from models.pose import RigidTransform

WIDTH_PX = 420
MARKED = "The true pose is cyan, a claimed one green"
VARIANT = "best"


def frame_pictures(plan: Plan, results: dict[str, Starts]) -> list[Picture]:
    """Return frames of each target, a third of each kind as far as there are any.

    Parameters
    ----------
    plan : Plan
    results : dict of Starts
        By target, of one variant.
    """
    pictures = []
    room = MOST_FRAMES // max(len(results), 1)
    for target in plan.targets:
        starts = results[plan.name(target)]
        for start in _chosen(starts, room):
            pictures.append(_picture(plan, target, starts, start))
    return pictures


def _chosen(starts: Starts, room: int) -> list[int]:
    """Choose wrong ones first, then as many refused as found, evenly among each."""
    wrong, refused = np.flatnonzero(starts.wrong), np.flatnonzero(~starts.claimed)
    found = np.flatnonzero(starts.right)
    chosen = wrong[: max(1, room // 3)].tolist()
    for own in (refused, found):
        left = (room - len(chosen)) // (2 if own is refused else 1)
        places = np.linspace(0, len(own) - 1, min(left, len(own))).round().astype(int)
        chosen += own[places].tolist()
    return chosen


def _picture(plan: Plan, target: str, starts: Starts, start: int) -> Picture:
    motion, number_of = divmod(start, SUNS)
    unit, frames = plan.starts(target, VARIANT)[motion], plan.frames(target)[motion]
    values = done_outcome(plan.out / "units", unit).values
    shown = done_outcome(plan.frames_folder, frames).values
    camera, detector, wireframe = known_of(frames.task)
    drawn = draw_motion(frames.task, camera, wireframe.radius_m)
    image = max(int(values["image"][number_of]), 0)
    truth, onboard = drawn.poses[image], OnboardKnowledge(camera=camera, wireframe=wireframe)
    canvas = Canvas.of(
        shown["images"][number_of, image], detector, WIDTH_PX, window_around(onboard, truth)
    )
    canvas.draw_edges(camera, wireframe, truth, TRUTH_CYAN)
    words = "refused: " + starts.reasons[start]
    if starts.claimed[start]:
        matrix = values["cam_from_target"][number_of]
        claimed = RigidTransform(matrix[:, :3], matrix[:, 3])
        canvas.draw_edges(camera, wireframe, claimed, ESTIMATE_GREEN)
        words = (
            f"{'WRONG' if starts.wrong[start] else 'found'} at image {image + 1}, "
            f"{number(float(starts.attitude_deg[start]))} deg and "
            f"{number(100.0 * float(starts.range_share[start]))} % of the range off"
        )
    return Picture(
        source=jpeg(canvas.picture),
        title=f"{plan.name(target)} {start} · Sun {starts.phase_deg[start]:.0f} deg off · "
        f"{100.0 * starts.lit[start]:.0f} % lit",
        verdict=words,
        lost=not bool(starts.right[start]),
    )
