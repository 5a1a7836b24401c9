"""How likely the best rival is wrong, counted: what ``pipelines.acquisition.rivals.Belief`` holds.

::

    python -m bench.suites.uncooperative_suns.calibration OUT --runs 100 --seeds 1 20

On frames of seeds that nothing else is told of the evidence of every start's best rival is noted
image by image, and whether it is wrong; a logistic regression of the one on the other is the
belief. Its weights have a Gaussian prior about none and the sign that sense has: more light
explained never makes a pose likelier to be wrong. How it does on starts that it was not fitted to
is told by leaving out one motion after the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from itertools import pairwise
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro
from scipy.optimize import minimize
from tyro.conf import Positional

from bench.suites.spread import do_units
from bench.suites.uncooperative_suns.cases import IMAGES
from bench.suites.uncooperative_suns.evidence import Row, evidence_units, replayed
from bench.suites.uncooperative_suns.plan import Plan, Sizes
from bench.suites.uncooperative_suns.results import DOUBT_EDGES, interval
from bench.suites.uncooperative_suns.targets import TARGETS
from bench.suites.units import done_outcome
from models.arrays import Floats, Mask
from models.errors import DatasetError
from pipelines.acquisition.rivals import Belief

PRIOR_SIGMAS = (20.0, 4.0, 15.0, 15.0, 6.0, 15.0)  # of the weights: 3 over what each term varies by
SIGNS = ((None, None), (None, 0.0), (None, 0.0), (None, 0.0), (0.0, None), (None, 0.0))
MOST_WRONG = 1.0 / 500.0  # of all starts
LIMITS = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1)


def fitted(rows: Sequence[Row]) -> Belief:
    """Return the belief under which what was noted is likeliest, weights towards none.

    Every start counts as one, however many images of it were noted: they are much alike.

    Parameters
    ----------
    rows : sequence of Row

    Raises
    ------
    DatasetError
        If all of them or none is wrong.
    """
    wrong: Mask = np.array([row.wrong for row in rows])
    if wrong.all() or not wrong.any():
        raise DatasetError(
            f"expected evidence of rivals that are wrong and of some that are right, got "
            f"{int(wrong.sum())} wrong of {len(wrong)}; give more --runs"
        )
    design = np.array([Belief().terms(row.standing) for row in rows])
    starts = [row.start for row in rows]
    counts = {start: starts.count(start) for start in set(starts)}
    weight = np.array([1.0 / counts[start] for start in starts])

    def cost(weights: Floats) -> float:
        odds = design @ weights
        likelihood = weight @ (np.logaddexp(0.0, odds) - np.where(wrong, odds, 0.0))
        off = weights / np.array(PRIOR_SIGMAS)
        return float(likelihood + 0.5 * off @ off)

    found = minimize(cost, np.zeros(len(SIGNS)), method="L-BFGS-B", bounds=SIGNS).x
    constant, lead, light, steps, spread, brightness = (round(float(each), 2) for each in found)
    return Belief(constant, lead, light, steps, spread, by_brightness=brightness)


def left_out(rows: Sequence[Row]) -> Floats:
    """Return the probability told of each row by a belief that its motion had no part in, (n,).

    Parameters
    ----------
    rows : sequence of Row
    """
    told = np.ones(len(rows))
    for motion in {row.start[:3] for row in rows}:
        belief = fitted([row for row in rows if row.start[:3] != motion])
        for place, row in enumerate(rows):
            if row.start[:3] == motion:
                told[place] = belief.wrong_probability(row.standing)
    return told


def claims(rows: Sequence[Row], told: Floats, most: float) -> tuple[int, int]:
    """Return how many starts end with a claim, at their first image that is sure enough, and wrong.

    Parameters
    ----------
    rows : sequence of Row
        Images of a start in order.
    told : (n,) array
        Probabilities that each is wrong.
    most : float
        With which a pose is claimed.
    """
    first: dict[tuple[str, int, int, int], bool] = {}
    for row, doubt in zip(rows, told.tolist(), strict=True):
        if doubt <= most and row.start not in first:
            first[row.start] = row.wrong
    return len(first), sum(first.values())


def limit_for(rows: Sequence[Row], told: Floats, most_wrong: float) -> float:
    """Return the largest probability up to which poses may be claimed.

    So many starts end with a claim then, and so surely, that of all starts no more than a share is
    expected to be wrong; 0 if none may be claimed.

    Parameters
    ----------
    rows : sequence of Row
        Images of a start in order.
    told : (n,) array
        Probabilities that each is wrong.
    most_wrong : float
        Share of all starts.
    """
    starts, best = len({row.start for row in rows}), 0.0
    for limit in np.unique(told).tolist():
        first: dict[tuple[str, int, int, int], float] = {}
        for row, doubt in zip(rows, told.tolist(), strict=True):
            if doubt <= limit:
                first.setdefault(row.start, doubt)
        if sum(first.values()) <= most_wrong * starts:
            best = limit
    return best


def account(rows: Sequence[Row]) -> str:
    """Say the belief that rows of evidence give, and what it would have claimed of others.

    Parameters
    ----------
    rows : sequence of Row

    Raises
    ------
    DatasetError
        If all of them or none is wrong.
    """
    belief, told = fitted(rows), left_out(rows)
    starts = len({row.start for row in rows})
    lines = [f"{len(rows)} images of {starts} starts, wrong {sum(row.wrong for row in rows)}"]
    lines += [f"{each.name} = {getattr(belief, each.name)}" for each in fields(belief)]
    limit = limit_for(rows, told, MOST_WRONG)
    lines.append(f"of all starts 1 in {1.0 / MOST_WRONG:.0f} is expected wrong below {limit:.3g}")
    for most in LIMITS:
        count, wrong = claims(rows, told, most)
        low, high = interval(wrong, count) if count else (0.0, 1.0)
        lines.append(
            f"below {most:g}: {count} starts claimed, {wrong} wrong, 95 % {low:.3f} to {high:.3f}"
        )
    return "\n".join([*lines, *reliability(rows, told)])


def reliability(rows: Sequence[Row], told: Floats) -> list[str]:
    """Hold what was told of each start's last image against what was wrong, by bins, in words.

    Parameters
    ----------
    rows : sequence of Row
        Images of a start in order.
    told : (n,) array
        Probabilities that each is wrong.
    """
    last = {row.start: place for place, row in enumerate(rows)}
    places = np.array(list(last.values()))
    doubts, wrong = told[places], np.array([rows[place].wrong for place in places])
    lines = []
    for least, most in pairwise(DOUBT_EDGES):
        own = (doubts >= least) & (doubts < most)
        if own.any():
            low, high = interval(int(wrong[own].sum()), int(own.sum()))
            lines.append(
                f"told {least:g} to {most:g}, {doubts[own].mean():.3f} in the mean: "
                f"{int(wrong[own].sum())} of {int(own.sum())} wrong, 95 % {low:.3f} to {high:.3f}"
            )
    return lines


def calibrate(
    out: Positional[Path],
    targets: Annotated[tuple[str, ...], tyro.conf.arg(help="as the suite's parts")] = TARGETS,
    runs: int = 100,
    seeds: tuple[int, ...] = (1, 20),
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
    runs : int
        Of each target and seed.
    seeds : tuple of int
        Of the motions: none that a count is to be of.
    images : int
        That a start looks at.
    workers : int
        Processes.
    """
    rows: list[Row] = []
    for seed in seeds:
        plan = Plan(Sizes(runs=runs, seed=seed), targets, out / f"seed-{seed}")
        folder = plan.out / "evidence"
        for target in targets:
            do_units(plan.frames(target), plan.frames_folder, workers)
            units = evidence_units(plan, target, images)
            do_units(units, folder, workers)
            for unit in units:
                rows += replayed(unit, done_outcome(folder, unit))
    print(account(rows))


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
