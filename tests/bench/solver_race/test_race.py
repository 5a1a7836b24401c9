"""The race of the solvers: all find the minimum and reach the bound; a bad one is told apart."""

import numpy as np
import pytest

from bench.solver_race.__main__ import main
from bench.solver_race.problems import drawn_problems
from bench.solver_race.race import bounds_of, race
from bench.solver_race.solvers import PEER, SOLVERS, in_a_batch, opencv_refined
from models.pose import RigidTransform
from pipelines.pnp.covariance import pose_covariance
from pipelines.pnp.problem import PnpProblem

COUNT = 300
SPREAD = 0.1  # of a root mean square of 1,800 errors, each 6 of which are of one problem: 3 sigma
AGREE = 0.02  # the line that the project draws: solvers of one minimum are equal far within it


@pytest.fixture(scope="module")
def problems():
    return drawn_problems(COUNT, 0.1, 3)


def test_all_solvers_find_one_minimum_and_reach_the_bound(problems):
    standings = race(problems, SOLVERS, 1)
    peer = next(own for own in standings if own.name == PEER)
    assert peer.times_faster == 1.0
    for own in standings:
        assert own.found == 1.0
        assert own.position_over_bound == pytest.approx(1.0, abs=SPREAD)
        assert own.attitude_over_bound == pytest.approx(1.0, abs=SPREAD)
        assert own.position_over_bound == pytest.approx(peer.position_over_bound, rel=AGREE)
        assert own.attitude_over_bound == pytest.approx(peer.attitude_over_bound, rel=AGREE)


def test_the_bound_is_that_of_one_problem(problems):
    for k in (0, COUNT - 1):
        one = PnpProblem(
            problems.points_in_target,
            problems.observed[k],
            np.broadcast_to(np.eye(2) / problems.sigma, (len(problems.points_in_target), 2, 2)),
        )
        pose = RigidTransform(problems.rotations[k], problems.translations[k])
        np.testing.assert_allclose(bounds_of(problems)[k], pose_covariance(one, pose), rtol=1e-6)


def test_a_solver_that_does_nothing_or_loses_some_is_told_apart(problems):
    def lazy(given):
        return given.start_rotations, given.start_translations

    def careless(given):
        rotations, translations = in_a_batch(given)
        translations[::3] = np.nan
        return rotations, translations

    standings = race(problems, {PEER: opencv_refined, "lazy": lazy, "careless": careless}, 1)
    assert standings[1].found < 0.01
    assert standings[2].found == pytest.approx(2.0 / 3.0)
    assert np.isfinite(standings[2].position_over_bound)


def test_the_command_prints_all_and_refuses_none(capsys):
    assert main(["--problems", "5", "--rounds", "1"]) == 0
    told = capsys.readouterr().out
    for name in SOLVERS:
        assert name in told
    with pytest.raises(SystemExit, match="2"):
        main(["--problems", "0"])
    assert "expected whole numbers from 1" in capsys.readouterr().err
