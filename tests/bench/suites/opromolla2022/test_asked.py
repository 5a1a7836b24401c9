"""What is asked is judged by the runs: made-up runs whose verdicts are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bench.suites.opromolla2022.asked import (
    CENTROIDS,
    HONEST,
    KEPT,
    LOST,
    MEAN,
    RATIO,
    STD,
    WRONG,
    AskedLine,
    asked_of_study,
    asked_of_table,
)
from bench.suites.opromolla2022.asked_tables import counts_asked, parameters_asked, tally
from bench.suites.opromolla2022.cases import BY_NAME, studies
from bench.suites.opromolla2022.results import FlownSequence, Results
from bench.suites.opromolla2022.summaries import (
    Runs,
    exact,
    lost_alone,
    over_paper,
    per_frame,
    statistics,
)
from bench.suites.units import Outcome

RUNS, FRAMES, MARKERS = 60, 12, 3
SIGMAS = np.array([1e-4, 1e-4, 5e-4, 0.01, 0.01, 0.001])  # m and deg


def outcome(rng: np.random.Generator, worse: float = 1.0) -> Outcome:
    """Return runs in which ``best`` errs as ``paper`` does, times a factor."""
    shape = (RUNS, FRAMES)
    paper = SIGMAS * rng.standard_normal((*shape, 6))
    values = {
        "time_s": np.arange(FRAMES, dtype=np.float64),
        "range_m": np.ones(FRAMES),
        "whole": np.ones((FRAMES, MARKERS), dtype=bool),
        "shown": np.ones((FRAMES, MARKERS)),
        "set/exact/errors": 0.5 * paper,
    }
    for variant, factor in (("paper", 1.0), ("best", worse)):
        errors = factor * paper
        values |= {
            f"set/{variant}/errors": errors,
            f"set/{variant}/attitude_deg": np.linalg.norm(errors[..., 3:], axis=2),
            f"set/{variant}/nees": rng.chisquare(6, shape),
            f"set/{variant}/wrong": np.zeros(shape, dtype=bool),
            f"set/{variant}/missed": np.zeros(shape, dtype=bool),
            f"set/{variant}/outline": np.zeros(shape, dtype=bool),
            f"set/{variant}/reason": np.full(shape, ""),
            f"set/{variant}/centroids": 0.05 * rng.standard_normal((*shape, MARKERS, 2)),
        }
    return Outcome(values, np.zeros(FRAMES))


def flown(own: Outcome, name: str = "S7", errors: str = "") -> FlownSequence:
    """Judge runs as those of a sequence, or as those of a study of it."""
    best, paper = (Runs([own], "set", variant) for variant in ("best", "paper"))
    met = {"best": per_frame(best), "paper": per_frame(paper)}
    told, peer = statistics(best), statistics(exact([own], "set"))
    over = over_paper(best, paper, by_runs=bool(errors))
    if errors:
        sequence = next(each for each in studies(name) if each.errors == errors)
        alone = lost_alone(best, paper)
        asked = asked_of_study(sequence.name, errors, over, met["best"], alone)
    else:
        sequence = BY_NAME[name]
        asked = asked_of_table(name, told, peer, over, met["best"])
    return FlownSequence(sequence, {"best": told, "exact": peer}, met, over, asked)


def line(own: FlownSequence, which: str) -> AskedLine:
    return next(each for each in own.asked if each.line == which)


def test_as_good_as_paper_holds_and_a_twentieth_worse_does_not() -> None:
    same = flown(outcome(np.random.default_rng(1)))
    assert [each.line for each in same.asked] == [RATIO, MEAN, STD]
    assert line(same, RATIO).holds
    assert [each.found for each in line(same, RATIO).figures] == pytest.approx([1.0] * 6)
    worse = line(flown(outcome(np.random.default_rng(1), worse=1.05)), RATIO)
    assert worse.holds is False
    assert [each.found for each in worse.figures] == pytest.approx([1.05] * 6)


def test_a_mean_is_held_to_its_runs_spread() -> None:
    own = outcome(np.random.default_rng(2))
    assert line(flown(own), MEAN).holds
    shifted = own.values["set/best/errors"] + [0, 0, 0, 0, 5.0 * 0.01 / np.sqrt(RUNS * FRAMES), 0]
    found = line(flown(replace(own, values=own.values | {"set/best/errors": shifted})), MEAN)
    assert [each.of for each in found.figures if each.holds is False] == ["beta"]


def test_a_std_is_held_to_the_larger_of_the_printed_and_the_exact_centroids() -> None:
    own = outcome(np.random.default_rng(3))
    wave = np.zeros((FRAMES, 6))
    wave[::2, 3] = 1.0  # deg, from frame to frame, in all runs
    many = own.values | {"set/best/errors": own.values["set/best/errors"] + wave}
    found = line(flown(replace(own, values=many)), STD)
    assert [each.of for each in found.figures if each.holds is False] == ["alpha"]
    peers = many | {"set/exact/errors": own.values["set/exact/errors"] + wave}
    assert line(flown(replace(own, values=peers)), STD).holds


def test_of_the_hand_lost_frames_and_centroids_are_asked_too() -> None:
    own = outcome(np.random.default_rng(4))
    assert line(flown(own, "E-SB"), LOST).holds
    seen = line(flown(own, "E-SB"), CENTROIDS)
    assert [(each.of, each.limit) for each in seen.figures] == [("u", 0.270), ("v", 0.075)]
    assert seen.holds
    own.values["set/best/errors"][3, 5] = np.nan
    lost = line(flown(own, "E-SB"), LOST)
    assert (lost.holds, lost.figures[0].found) == (False, 1.0)


def test_under_all_errors_covariances_losses_and_wrong_poses_are_asked() -> None:
    own = outcome(np.random.default_rng(5))
    good = flown(own, errors="realistic")
    assert [each.line for each in good.asked] == [RATIO, HONEST, KEPT, WRONG]
    assert [each.line for each in flown(own, errors="clock").asked] == [RATIO]
    assert line(good, KEPT).holds
    assert line(good, WRONG).holds
    own.values["set/best/nees"] *= 1.6  # over sixty runs 1 has a standard deviation of 7 %
    own.values["set/best/wrong"][0, 0] = True
    own.values["set/best/errors"][1, 2] = np.nan
    bad = flown(own, errors="realistic")
    assert [line(bad, which).holds for which in (HONEST, KEPT, WRONG)] == [False] * 3
    own.values["set/paper/errors"][1, 2] = np.nan
    assert line(flown(own, errors="realistic"), KEPT).holds


def test_what_too_few_frames_or_runs_cannot_tell_is_not_judged() -> None:
    own = outcome(np.random.default_rng(6))
    few = {
        key: each[:1, :5] if key.startswith("set/") else each[:5]
        for key, each in own.values.items()
    }
    judged = flown(replace(own, values=few))
    assert line(judged, RATIO).holds is None
    assert line(judged, MEAN).holds is None


def test_the_tables_have_every_line_with_its_figure_and_limit() -> None:
    rng = np.random.default_rng(7)
    hand, under = flown(outcome(rng, 1.05), "E-SB"), flown(outcome(rng), errors="realistic")
    results = Results((hand,), (), {"S7": (under,)})
    of_parameters = parameters_asked(results)
    assert len(of_parameters.rows) == 3 + 1
    near = Results((flown(outcome(np.random.default_rng(8), 1.0202)),), (), {})
    assert parameters_asked(near).rows[0][1] == "1.0202 > 1.02"
    assert of_parameters.rows[0] == [RATIO, *["1.05 > 1.02"] * 6, "does not hold"]
    counted = {tuple(row[:2]): row[2:] for row in counts_asked(results).rows}
    assert counted[LOST, "E-SB"] == ["0 ≤ 0", "holds"]
    assert set(counted) >= {
        (CENTROIDS, "E-SB u"),
        (HONEST, "S7/realistic"),
        (WRONG, "S7/realistic"),
    }
    held, judged = tally(results)
    assert judged == len(hand.asked) + len(under.asked)
    assert held < judged
