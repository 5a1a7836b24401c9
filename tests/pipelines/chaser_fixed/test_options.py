"""Every setting of Table 11, and the variants by name."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, fields, replace

import pytest

from models.errors import ScenarioError
from pipelines.chaser_fixed.options import (
    VARIANTS,
    ChaserFixedOptions,
    LevenbergMarquardtOptions,
    options_for,
)

TABLE_11 = {"tau_bin": 0.2, "tau_circ": 0.5, "s_ao": 0.6, "s_bord": 1.2, "s_id": 2.0}
TABLE_11_SOLVER = {
    "eps0": 1e-9,
    "eps1": 1e-10,
    "eps2": 1e-4,
    "eps3": 1e-8,
    "max_iterations": 200,
    "lambda0": 1e-8,
    "lambda_up": 11.0,
    "lambda_down": 9.0,
}


def test_the_paper_variant_is_table_11() -> None:
    paper = options_for("paper")
    assert {name: getattr(paper, name) for name in TABLE_11} == TABLE_11
    assert {name: getattr(paper.solver, name) for name in TABLE_11_SOLVER} == TABLE_11_SOLVER
    assert paper.solver.lambda_rule == "paper"
    assert paper.solver.parametrisation == "euler_321"


def test_variants_are_known_by_name() -> None:
    assert VARIANTS == ("paper", "best")
    for name in VARIANTS:
        assert options_for(name).variant == name


def test_an_unknown_variant_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ScenarioError, match="paper, best, got 'bets'"):
        options_for("bets")


@pytest.mark.parametrize(
    ("setting", "value"),
    [
        ("tau_bin", 0.0),
        ("tau_bin", 1.5),
        ("s_ao", -0.1),
        ("s_id", float("nan")),
        ("min_markers", 2),
    ],
)
def test_settings_that_make_no_sense_are_refused(setting: str, value: float) -> None:
    with pytest.raises(ScenarioError, match=setting):
        replace(options_for("best"), **{setting: value})


def test_options_are_frozen() -> None:
    with pytest.raises(FrozenInstanceError):
        options_for("best").tau_bin = 0.3  # type: ignore[misc]


@pytest.mark.parametrize("options", [ChaserFixedOptions, LevenbergMarquardtOptions])
def test_every_setting_is_documented(options: type) -> None:
    for field in fields(options):
        assert field.name in (options.__doc__ or "")
