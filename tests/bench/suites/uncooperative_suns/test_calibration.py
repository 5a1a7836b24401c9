"""A belief that is fitted to counted evidence holds its rate on evidence that it has not seen."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.stats import binom

from bench.suites.uncooperative_suns.calibration import (
    account,
    claims,
    fitted,
    left_out,
    limit_for,
)
from bench.suites.uncooperative_suns.evidence import Row
from models.errors import DatasetError
from pipelines.acquisition.rivals import Belief, Standing

TRUE = Belief(6.0, -2.5, -6.0, -5.0, 1.0, least=1e-6)
CHANCE = 1e-3  # that a right belief fails in one of the bins
EDGES = (0.0, 0.01, 0.05, 0.2, 0.5, 1.0)


def evidence(seed: int, starts: int, images: int = 2) -> list[Row]:
    """Return starts of which each image is wrong with the probability that ``TRUE`` tells."""
    rng = np.random.default_rng(seed)
    rows = []
    for start in range(starts):
        for image in range(images):
            light, steps = rng.uniform(0.2, 1.0, 2)
            standing = Standing(8.0 * rng.random(), light, steps, 10.0 ** rng.uniform(-3.0, -1.0))
            wrong = bool(rng.random() < TRUE.wrong_probability(standing))
            rows.append(Row(("drawn", 1, start // 4, start % 4), image, standing, wrong))
    return rows


def test_what_is_told_holds_on_starts_that_tuned_nothing() -> None:
    belief, fresh = fitted(evidence(1, 1500)), evidence(2, 1500)
    told = np.array([belief.wrong_probability(row.standing) for row in fresh])
    wrong = np.array([row.wrong for row in fresh])
    for low, high in pairwise(EDGES):
        own = (told >= low) & (told < high)
        most_likely = binom(int(own.sum()), float(told[own].mean())).interval(1.0 - CHANCE)
        assert most_likely[0] <= wrong[own].sum() <= most_likely[1]


def test_few_starts_are_believed_less_than_many() -> None:
    """Where a lead above 2 was never wrong, four starts say so less surely than four hundred."""

    def separable(starts: int) -> list[Row]:
        return [
            Row(("drawn", 1, k, 0), 0, Standing(1.0 + 2.0 * (k % 2), 0.5, 0.5, 0.01), k % 2 == 0)
            for k in range(starts)
        ]

    ahead = Standing(3.0, 0.5, 0.5, 0.01)
    few, many = (fitted(separable(starts)).wrong_probability(ahead) for starts in (4, 400))
    assert few > 3.0 * many


def test_more_light_never_makes_a_pose_likelier_wrong() -> None:
    """Evidence in which it does is of chance."""
    rows = [
        Row(("drawn", 1, k, 0), 0, Standing(1.0, 0.9 if k % 3 else 0.2, 0.5, 0.01), k % 3 > 0)
        for k in range(30)
    ]
    assert fitted(rows).by_light == 0.0


def test_a_motion_has_no_part_in_what_is_told_of_it() -> None:
    rows = evidence(3, 24)
    told = left_out(rows)
    own = [row for row in rows if row.start[2] == 0]
    flipped = [Row(r.start, r.image, r.standing, not r.wrong) for r in own] + rows[len(own) :]
    np.testing.assert_array_equal(left_out(flipped)[: len(own)], told[: len(own)])


def test_a_start_ends_with_its_first_sure_image() -> None:
    standing = Standing(1.0, 0.5, 0.5, 0.01)
    rows = [Row(("a", 1, 0, 0), k, standing, k == 1) for k in range(3)]
    assert claims(rows, np.array([0.5, 0.01, 0.001]), 0.02) == (1, 1)
    assert claims(rows, np.array([0.5, 0.03, 0.001]), 0.02) == (1, 0)
    assert claims(rows, np.array([0.5, 0.03, 0.03]), 0.02) == (0, 0)


def test_the_limit_is_what_a_share_of_all_starts_allows() -> None:
    """Of 100 starts, ten that tell 0.01 and ten that tell 0.02: 0.1 and 0.3 are expected wrong."""
    standing = Standing(1.0, 0.5, 0.5, 0.01)
    rows = [Row(("a", 1, k, 0), 0, standing, False) for k in range(100)]
    told = np.where(np.arange(100) < 10, 0.01, np.where(np.arange(100) < 20, 0.02, 0.5))
    assert limit_for(rows, told, 0.002) == 0.01
    assert limit_for(rows, told, 0.003) == 0.02
    assert limit_for(rows, told, 1e-4) == 0.0


def test_evidence_of_one_kind_is_refused() -> None:
    rows = [row for row in evidence(4, 40) if not row.wrong]
    with pytest.raises(DatasetError, match="more --runs"):
        account(rows)
