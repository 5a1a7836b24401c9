"""How likely the best rival is wrong, counted: what ``pipelines.acquisition.rivals.Belief`` holds.

::

    python -m bench.suites.uncooperative_suns.calibration OUT --runs 48 --seed 100

On frames of a seed that nothing else is told of, every start looks at all of its images and claims
nothing; at each the evidence of the best rival is noted, and whether it is wrong. A logistic
regression of the one on the other is the belief.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro
from scipy.optimize import minimize
from tyro.conf import Positional

from bench.scoring.tumble.navigation_errors import symmetric_attitude_deg
from bench.suites.spread import do_units
from bench.suites.uncooperative_suns.cases import (
    IMAGES,
    SUN_SIGMA_DEG,
    SUNS,
    MotionTask,
    draw_motion,
    told_sun,
)
from bench.suites.uncooperative_suns.frames import known_of
from bench.suites.uncooperative_suns.plan import Plan, Sizes
from bench.suites.uncooperative_suns.results import WRONG_DEG, WRONG_SHARE
from bench.suites.uncooperative_suns.starts import frames_unit
from bench.suites.units import Outcome, WorkUnit, done_outcome
from models.arrays import Floats, Mask
from models.errors import DatasetError
from models.pose import RigidTransform
from pipelines.acquisition.rivals import Belief, RivalOptions, Rivals, Verdict
from pipelines.acquisition.sunlit_start import SunlitStart, SunlitStartOptions
from pipelines.acquisition.under_sun import (
    SIGMAS_OF_FITNESS,
    UnderSun,
    UnderSunOptions,
    make_views,
)

PRIOR_WEIGHT = 0.05  # of the squares of the regression's weights: few starts fix none sharply
START_S = 12.0
FITS = ("fitness", "preferred", "light", "steps", "range_sigma")  # of a candidate


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
        ``pose`` (k, images, finalists, 3, 4) and ``fits`` (k, images, finalists, 5), the numbers of
        ``Noted``: NaN where there was no candidate. Seconds of one core, by start.
    """
    motion, place = task.motion, Path(frames)
    shown = done_outcome(place.parents[1], frames_unit(motion, place.parent.name)).values
    camera, detector, wireframe = known_of(motion)
    drawn = draw_motion(motion, camera, wireframe.radius_m)
    options = UnderSunOptions()
    make_views(wireframe, options)
    silent = SunlitStartOptions(rivals=RivalOptions(most_wrong=-1.0))
    shape = (SUNS, task.images, options.finalists)
    poses, fits = np.full((*shape, 3, 4), np.nan), np.full((*shape, len(FITS)), np.nan)
    seconds = np.zeros(SUNS)
    for number in range(SUNS):
        sun = told_sun(motion, number, drawn.suns_in_inertial[number], task.sun_sigma_deg)
        start = SunlitStart(UnderSun(wireframe, camera, detector, options), silent)
        began = time.process_time()
        for image in range(task.images):
            sun_in_cam = drawn.cam_from_inertial(image) @ sun
            time_s = float(drawn.times_s[image])
            said = start.take(shown["images"][number, image], time_s, sun_in_cam)
            for k, one in enumerate(said.candidates):
                poses[number, image, k] = one.pose.matrix()[:3]
                fits[number, image, k] = [getattr(one, name) for name in FITS]
            if said.over:
                break
        seconds[number] = time.process_time() - began
    return Outcome({"pose": poses, "fits": fits}, seconds)


@dataclass(frozen=True, eq=False)
class Noted:
    """A candidate as it was noted; see ``pipelines.acquisition.under_sun.Candidate``."""

    pose: RigidTransform
    fitness: float
    preferred: float
    light: float
    steps: float
    range_sigma: float

    @property
    def score(self) -> float:
        """How it fits, as a candidate has it."""
        return SIGMAS_OF_FITNESS * self.fitness + self.preferred


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
        rivals = Rivals(looking, RivalOptions(), belief or Belief())
        for image in range(unit.task.images):
            own = [
                Noted(RigidTransform(pose[:, :3], pose[:, 3]), *fit)
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
            start = (motion.target, motion.number, number)
            rows.append(Row(start, image, verdict, turn_deg, bool(wrong)))
    return rows


@dataclass(frozen=True, eq=False)
class Row:
    """What one image of one start came to.

    Attributes
    ----------
    start : (str, int, int)
        Target, motion and Sun.
    image : int
    verdict : Verdict
    turn_deg : float, deg
        Between its best pose and the true one.
    wrong : bool
    """

    start: tuple[str, int, int]
    image: int
    verdict: Verdict
    turn_deg: float
    wrong: bool


def fitted(margin: Floats, light: Floats, steps: Floats, wrong: Mask) -> Belief:
    """Return the belief under which what was noted is likeliest, weights towards 0.

    Parameters
    ----------
    margin, light, steps : (n,) arrays
    wrong : (n,) array of bool
    """
    design = np.stack([np.ones_like(margin), margin, light, steps], axis=1)

    def cost(weights: Floats) -> float:
        odds = design @ weights
        likelihood = np.logaddexp(0.0, odds).sum() - odds[wrong].sum()
        return float(likelihood + PRIOR_WEIGHT * (weights[1:] ** 2).sum())

    found = minimize(cost, np.zeros(4), method="BFGS").x
    return Belief(*(round(float(each), 2) for each in found))


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


def calibrate(
    out: Positional[Path],
    targets: Annotated[tuple[str, ...], tyro.conf.arg(help="as the suite's parts")] = (
        "xmm",
        "hispasat",
    ),
    runs: int = 48,
    seed: int = 100,
    images: int = IMAGES,
    workers: int = 1,
) -> None:
    """Render what is missing, note the evidence and print the belief that it gives.

    Parameters
    ----------
    out : Path
        Folder of the frames and of what was noted.
    targets : tuple of str
        As the suite's parts.
    runs, seed : int
        Of the motions.
    images : int
        That a start looks at.
    workers : int
        Processes.
    """
    plan = Plan(Sizes(runs=runs, seed=seed), targets, out)
    noted: list[Floats] = []
    for target in targets:
        do_units(plan.frames(target), plan.frames_folder, workers)
        units = evidence_units(plan, target, images)
        do_units(units, out / "evidence", workers)
        noted += [_rows(done_outcome(out / "evidence", unit)) for unit in units]
    print(told(np.concatenate(noted)))


def _rows(outcome: Outcome) -> Floats:
    rows = np.stack([outcome.values[name].ravel() for name in (*COLUMNS, "wrong")], axis=1)
    return np.asarray(rows[np.isfinite(rows).all(axis=1)])


def told(rows: Floats) -> str:
    """Say the belief that rows of evidence, (n, 4), give, and what it would have claimed.

    Raises
    ------
    DatasetError
        If all of them or none is wrong.
    """
    wrong = rows[:, 3] > 0.5
    if wrong.all() or not wrong.any():
        raise DatasetError(
            f"expected evidence of rivals that are wrong and of some that are right, got "
            f"{int(wrong.sum())} wrong of {len(wrong)}; give more --runs"
        )
    belief = fitted(rows[:, 0], rows[:, 1], rows[:, 2], wrong)
    doubts = np.array([belief.wrong_probability(*row[:3]) for row in rows])
    lines = [f"{len(rows)} images, the best rival wrong in {int(wrong.sum())}"]
    lines += [f"{each.name} = {getattr(belief, each.name)}" for each in fields(belief)]
    for most in (0.01, 0.02, 0.05, 0.1):
        claimed = doubts <= most
        lines.append(
            f"below {most:g}: {int(claimed.sum())} claims, {int((claimed & wrong).sum())} wrong"
        )
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> None:
    """Read the command line and calibrate.

    Parameters
    ----------
    arguments : sequence of str, optional
        Those of the command line unless given.
    """
    tyro.cli(calibrate, args=arguments)


if __name__ == "__main__":
    main()
