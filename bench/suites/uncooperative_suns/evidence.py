"""What starts see of training seeds, noted once: beliefs are fitted to it in seconds.

Every start looks at its images and claims nothing; of each image its candidates are kept, and the
rivals are carried on anew from these whenever they are wanted.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.scoring.tumble.navigation_errors import symmetric_attitude_deg
from bench.suites.uncooperative_suns.cases import (
    SUN_SIGMA_DEG,
    SUNS,
    MotionTask,
    draw_motion,
)
from bench.suites.uncooperative_suns.frames import known_of
from bench.suites.uncooperative_suns.plan import Plan
from bench.suites.uncooperative_suns.results import WRONG_DEG, WRONG_SHARE
from bench.suites.uncooperative_suns.starts import frames_unit
from bench.suites.uncooperative_suns.told import onboard_of
from bench.suites.units import Outcome, WorkUnit, done_outcome
from models.errors import DatasetError
from models.pose import RigidTransform
from pipelines.acquisition.candidate import score_of
from pipelines.acquisition.rivals import Belief, RivalOptions, Rivals, Standing
from pipelines.acquisition.sunlit_start import SunlitStart, SunlitStartOptions
from pipelines.acquisition.under_sun import UnderSun, make_views
from pipelines.acquisition.under_sun_options import UnderSunOptions
from pipelines.uncooperative.knowledge import UncooperativeKnowledge

START_S = 6.0
FITS = ("fitness", "preferred", "light", "steps", "range_sigma", "brightness")  # of a candidate


@dataclass(frozen=True)
class EvidenceTask:
    """The starts of one motion.

    Attributes
    ----------
    motion : MotionTask
    frames : str
        Hash of all that shapes the frames.
    images : int
        That each looks at.
    settings : str
        Of the search, as text.
    sun_sigma_deg : float, deg
    """

    motion: MotionTask
    frames: str
    images: int
    settings: str
    sun_sigma_deg: float


def evidence(task: EvidenceTask, frames: str) -> Outcome:
    """Note what every start saw, image by image, claiming nothing.

    Parameters
    ----------
    task : EvidenceTask
    frames : str
        The frames' file, without suffix.

    Returns
    -------
    Outcome
        ``pose`` (k, images, finalists, 3, 4) and ``fits`` (k, images, finalists, 6), the numbers of
        ``Noted``: NaN where there was no candidate. Seconds of one core, by start.

    Raises
    ------
    DatasetError
        If the Sun is not on board.
    """
    motion, place = task.motion, Path(frames)
    shown = done_outcome(place.parents[1], frames_unit(motion, place.parent.name)).values
    camera, _, wireframe = known_of(motion)
    drawn = draw_motion(motion, camera, wireframe.radius_m)
    options = UnderSunOptions()
    silent = SunlitStartOptions(rivals=RivalOptions(most_wrong=-1.0))
    shape = (SUNS, task.images, options.finalists)
    poses, fits = np.full((*shape, 3, 4), np.nan), np.full((*shape, len(FITS)), np.nan)
    seconds = np.zeros(SUNS)
    for number in range(SUNS):
        onboard = onboard_of(motion, drawn, number, task.sun_sigma_deg)
        known = UncooperativeKnowledge.of(onboard)
        make_views(known.target, options)
        looking = UnderSun(known.target, known.camera, known.detector, options)
        start = SunlitStart(looking, silent)
        began = time.process_time()
        for image in range(task.images):
            exposure_ms = float(shown["exposure_ms"][number, image])
            daylight = known.daylight(drawn.chaser(image), exposure_ms)
            if daylight is None:
                raise DatasetError("expected the Sun's direction on board, got none")
            time_s = float(drawn.times_s[image])
            said = start.take(shown["images"][number, image], time_s, daylight)
            for k, one in enumerate(said.candidates):
                poses[number, image, k] = one.pose.matrix()[:3]
                given = [getattr(one, name) for name in FITS]
                fits[number, image, k] = [np.nan if each is None else each for each in given]
            if said.over:
                break
        seconds[number] = time.process_time() - began
    return Outcome({"pose": poses, "fits": fits}, seconds)


@dataclass(frozen=True, eq=False)
class Row:
    """What one image of one start came to.

    Attributes
    ----------
    start : (str, int, int, int)
        Target, seed, motion and Sun.
    image : int
    standing : Standing
        Of the best rival.
    wrong : bool
        Whether its pose is.
    """

    start: tuple[str, int, int, int]
    image: int
    standing: Standing
    wrong: bool


@dataclass(frozen=True, eq=False)
class Noted:
    """A candidate as it was noted; see ``pipelines.acquisition.candidate.Candidate``."""

    pose: RigidTransform
    fitness: float
    preferred: float
    light: float
    steps: float
    range_sigma: float
    brightness: float | None

    @property
    def score(self) -> float:
        """How it fits, as a candidate has it."""
        return score_of(self.fitness, self.preferred, self.brightness)


def replayed(unit: WorkUnit, outcome: Outcome, belief: Belief | None = None) -> list[Row]:
    """Carry the rivals of noted starts on anew.

    Parameters
    ----------
    unit : WorkUnit
        That noted them.
    outcome : Outcome
    belief : Belief, optional

    Returns
    -------
    list of Row
        One for each image that had candidates.
    """
    motion: MotionTask = unit.task.motion
    camera, detector, wireframe = known_of(motion)
    drawn = draw_motion(motion, camera, wireframe.radius_m)
    looking = UnderSun(wireframe, camera, detector, UnderSunOptions())
    rows = []
    for number in range(SUNS):
        rivals: Rivals[Noted] = Rivals(looking, RivalOptions(), belief or Belief())
        for image in range(unit.task.images):
            own = [
                _noted(RigidTransform(pose[:, :3], pose[:, 3]), fit)
                for pose, fit in zip(
                    outcome.values["pose"][number, image],
                    outcome.values["fits"][number, image].tolist(),
                    strict=True,
                )
                if np.isfinite(fit[0])
            ]
            if not own:
                continue
            verdict = rivals.add(float(drawn.times_s[image]), tuple(own))
            pose, truth = verdict.best.pose, drawn.poses[image]
            off = np.linalg.norm(pose.translation - truth.translation)
            turn_deg = symmetric_attitude_deg(pose, truth, wireframe.symmetries)
            wrong = turn_deg > WRONG_DEG or off > WRONG_SHARE * np.linalg.norm(truth.translation)
            start = (motion.target, motion.seed, motion.number, number)
            rows.append(Row(start, image, verdict.standing, bool(wrong)))
    return rows


def _noted(pose: RigidTransform, fit: list[float]) -> Noted:
    fitness, preferred, light, steps, range_sigma, brightness = fit
    known = None if np.isnan(brightness) else brightness
    return Noted(pose, fitness, preferred, light, steps, range_sigma, known)


def evidence_units(plan: Plan, target: str, images: int) -> list[WorkUnit]:
    """Return the units that note the evidence of a target's starts.

    Parameters
    ----------
    plan : Plan
    target : str
    images : int
        That a start looks at.
    """
    settings = repr((UnderSunOptions(), RivalOptions()))
    return [
        WorkUnit(
            name=f"{plan.name(target)}/{unit.task.number:04d}",
            work=evidence,
            task=EvidenceTask(unit.task, unit.key, images, settings, SUN_SIGMA_DEG),
            kind=f"evidence, {target}",
            expected_s=SUNS * START_S,
            reads=str(plan.frames_folder / unit.name),
        )
        for unit in plan.frames(target)
    ]
