"""How tumbles are judged: what is wrong, how long it is held, which covariances are honest."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench.suites.uncooperative_tumbles.cases import DrawnTumble
from bench.suites.uncooperative_tumbles.page import asked_of
from bench.suites.uncooperative_tumbles.results import Followed, longest_run, summary_of
from models.arrays import Floats

DRAWN = DrawnTumble(
    Rotation.identity(), np.array([0.5, 0.0, 0.0]), np.array([0.0, 40.0, 0.0]), 5.0, 0.1, 60.0,
    np.array([1.0, 0.0, 0.0]), True,
)  # fmt: skip
RANGE_M = 40.0
IMAGES = 8
HONEST = 6.0  # the mean of a chi-square of six degrees of freedom


def followed(
    alike_deg: list[float],
    position_m: list[float] | None = None,
    raw: tuple[float, float] = (0.1, 1.0),
    nees: float = HONEST,
) -> Followed:
    """Return a tumble of given attitude errors; NaN without a state."""
    alike = np.array(alike_deg)
    stands = np.isfinite(alike)
    place = np.full(len(alike), 0.1) if position_m is None else np.array(position_m)

    def where_it_stands(value: Floats | float) -> Floats:
        return np.where(stands, value, np.nan)

    return Followed(
        drawn=DRAWN,
        lit=np.full(len(alike), 0.5),
        range_m=np.full(len(alike), RANGE_M),
        alike_deg=alike,
        position_m=where_it_stands(place),
        attitude_deg=alike,
        raw_position_m=np.full(len(alike), raw[0]),
        raw_attitude_deg=np.full(len(alike), raw[1]),
        nees_translation=where_it_stands(nees),
        nees_rotation=where_it_stands(nees),
        seconds=np.ones(len(alike)),
        reasons=("",) * len(alike),
    )


NONE = float("nan")


def test_a_state_is_wrong_by_its_attitude_or_by_its_place() -> None:
    one = followed([NONE, 1.0, 12.0, 1.0], [0.1, 0.1, 0.1, 0.06 * RANGE_M])
    assert one.wrong.tolist() == [False, False, True, True]
    assert one.right.tolist() == [False, True, False, False]
    assert one.first_right == 2
    assert one.longest_wrong == 2


@pytest.mark.parametrize(
    ("flags", "expected"), [([], 0), ([0, 0], 0), ([1, 1, 0, 1], 2), ([0, 1, 1, 1], 3)]
)
def test_the_longest_run(flags: list[int], expected: int) -> None:
    assert longest_run(np.array(flags, dtype=bool)) == expected


def test_a_wrong_state_held_for_three_images_is_borne_and_for_four_is_not() -> None:
    three = summary_of([followed([1.0, 90.0, 90.0, 90.0, 1.0])])
    four = summary_of([followed([1.0, 90.0, 90.0, 90.0, 90.0])])
    assert [asked_of(one)[0][2] for one in (three, four)] == [True, False]


@pytest.mark.parametrize(("nees", "holds"), [(HONEST, True), (9.0, False), (3.0, False)])
def test_covariances_too_small_and_too_large_are_both_told(nees: float, holds: bool) -> None:
    one = summary_of([followed([1.0] * IMAGES, nees=nees)])
    assert one.nees_translation == pytest.approx(nees / HONEST)
    assert [each[2] for each in asked_of(one)[1:3]] == [holds, holds]


def test_wrong_states_do_not_enter_what_is_said_of_right_ones() -> None:
    one = followed([1.0, 170.0])
    one.nees_rotation[1] = 1e9
    assert one.nees("rotation") == pytest.approx(1.0)


def test_the_filter_is_held_against_the_poses_of_the_same_images() -> None:
    better, worse = followed([0.5] * IMAGES), followed([2.0] * IMAGES)
    one = summary_of([better, worse, followed([NONE] * IMAGES)])
    assert one.filter_worse == {"position_m": [0, 2], "attitude_deg": [1, 2]}
    assert (one.acquired, one.tumbles) == (2, 3)


def test_a_pose_that_is_wrong_itself_says_nothing_for_the_filter() -> None:
    """It is refused: the state beside it is no better for that."""
    one = followed([1.0] * IMAGES, raw=(0.1, 175.0))
    assert one.root_mean_square("attitude_deg") is None


def test_where_nothing_stands_nothing_is_judged() -> None:
    rows = asked_of(summary_of([followed([NONE] * IMAGES)]))
    assert [holds for _, _, holds in rows] == [True, None, None, None, None]
