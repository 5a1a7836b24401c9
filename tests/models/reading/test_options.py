from __future__ import annotations

import numpy as np
import pytest

from models.errors import ScenarioError
from models.reading.options import check_option


@pytest.mark.parametrize("value", [None, 1, 1.5, 3])
def test_what_is_within_is_taken(value: float | None) -> None:
    check_option("--it", value, 1, 3)


@pytest.mark.parametrize("value", [0.9, 4, np.nan, np.inf, -np.inf, True, "2"])
def test_what_is_not_is_refused_and_the_range_told(value: float) -> None:
    with pytest.raises(ScenarioError, match=r"expected --it from 1 to 3, got .*; or so"):
        check_option("--it", value, 1, 3, hint="or so")


@pytest.mark.parametrize("value", [1.5, 2.0, "2"])
def test_a_whole_number_is_one(value: float) -> None:
    with pytest.raises(ScenarioError, match=r"expected --it a whole number from 1 to 4294967296"):
        check_option("--it", value, 1, 2**32, whole=True)


def test_a_range_may_have_no_end() -> None:
    check_option("--it", np.inf, 0.0, np.inf)
    with pytest.raises(ScenarioError, match=r"expected --it of at least 0, got nan"):
        check_option("--it", np.nan, 0.0, np.inf)
