"""How likely the best rival is wrong, counted: what ``pipelines.acquisition.rivals.Belief`` holds.

::

    python -m bench.suites.uncooperative_suns.calibration OUT --runs 48 --seed 100

On frames of a seed that nothing else is told of, every start looks at all of its images and claims
nothing; at each the evidence of the best rival is noted, and whether it is wrong. A logistic
regression of the one on the other is the belief.
"""

from __future__ import annotations

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
from pipelines.acquisition.rivals import Belief, RivalOptions, Rivals
from pipelines.acquisition.under_sun import UnderSun, UnderSunOptions

PRIOR_WEIGHT = 0.05  # of the squares of the regression's weights: few starts fix none sharply
START_S = 12.0
COLUMNS = ("margin", "light", "steps")


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
    """Note the evidence of every start's best rival, image by image.

    Parameters
    ----------
    task : EvidenceTask
    frames : str
        The frames' file, without suffix.

    Returns
    -------
    Outcome
        ``margin``, ``light``, ``steps``, ``wrong`` (k, images); NaN where there was no rival.
    """
    motion, place = task.motion, Path(frames)
    shown = done_outcome(place.parents[1], frames_unit(motion, place.parent.name)).values
    camera, detector, wireframe = known_of(motion)
    drawn = draw_motion(motion, camera, wireframe.radius_m)
    looking = UnderSun(wireframe, camera, detector, UnderSunOptions())
    names = (*COLUMNS, "wrong")
    values = {name: np.full((SUNS, task.images), np.nan) for name in names}
    for number in range(SUNS):
        sun = told_sun(motion, number, drawn.suns_in_inertial[number], task.sun_sigma_deg)
        rivals = Rivals(looking, RivalOptions(), Belief())
        for image in range(task.images):
            time_s, truth = float(drawn.times_s[image]), drawn.poses[image]
            pixels = shown["images"][number, image]
            sun_in_cam = drawn.cam_from_inertial(image) @ sun
            looked = looking.look(pixels, sun_in_cam, rivals.foreseen(time_s))
            if not looked.candidates:
                continue
            verdict = rivals.add(time_s, looked.candidates)
            pose = verdict.best.pose
            off = np.linalg.norm(pose.translation - truth.translation)
            turn_deg = symmetric_attitude_deg(pose, truth, wireframe.symmetries)
            values["margin"][number, image] = verdict.margin
            values["light"][number, image] = verdict.light
            values["steps"][number, image] = verdict.steps
            values["wrong"][number, image] = turn_deg > WRONG_DEG or bool(
                off > WRONG_SHARE * np.linalg.norm(truth.translation)
            )
    return Outcome(values, np.zeros(0))


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
    images: int = 3,
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
