"""The whole suite, tiny: the same numbers however it is run, and a page that opens by itself."""

import io
import json
import re
import shutil
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from bench.suites.pesce2019.suite import without_times
from bench.suites.request import SuiteRequest
from bench.suites.units import Outcome, outcome_path
from bench.suites.volpe2017 import shape_bound
from bench.suites.volpe2017.cases import paper_case
from bench.suites.volpe2017.motion_errors import COLUMNS
from bench.suites.volpe2017.plan import PARTS, QUICK, Plan, Sizes
from bench.suites.volpe2017.suite import plan_of, run_plan
from bench.suites.volpe2017.summaries import Runs, against_bound, improvements, went_astray
from models.errors import ScenarioError

SIZES = Sizes(runs=2, paper_runs=1, seeds=1, duration_s=60.0, study_s=10.0, speed_s=6.0)
PLAN = Plan(SIZES)
QUIET = Console(file=io.StringIO())


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    out = tmp_path_factory.mktemp("suite") / "out"
    run_plan(PLAN, out, 1, QUIET)
    return out


def document(out):
    return without_times(json.loads((out / "suite.json").read_text()))


@pytest.mark.slow
def test_after_a_stop_it_writes_the_same(done, tmp_path):
    out = tmp_path / "out"
    shutil.copytree(done, out)
    part = replace(PLAN, parts=("paper",))
    gone = part.units()[1:]
    before = {unit.name: outcome_path(done / "units", unit).read_bytes() for unit in gone}
    for unit in gone:
        outcome_path(out / "units", unit).unlink()
    run_plan(part, out, 1, QUIET)
    assert document(out)["parts"]["paper"] == document(done)["parts"]["paper"]
    for unit in gone:
        assert outcome_path(out / "units", unit).read_bytes() == before[unit.name]


def test_the_page_opens_offline_and_has_figures_6_to_10(done):
    text = (done / "suite.html").read_text()
    assert not re.search("https?:", text.replace("http://www.w3.org", ""))
    for number in (6, 7, 8, 9, 10):
        assert f"Figure {number}" in text
    assert "Table 1" in text
    assert "Table 2" in text
    assert "without range" in text


def test_every_part_is_there(done):
    parts = json.loads((done / "suite.json").read_text())["parts"]
    assert set(parts["paper"]["table2"]) == {"paper", "best"}
    assert len(parts["observability"]) == 10
    assert len(parts["tracks"]) == 8
    assert [step["points"] for step in parts["frame_ms"]] == [12, 50, 100, 200]


def test_units_are_named_once():
    units = Plan(QUICK).units()
    assert len({unit.name for unit in units}) == len(units)


def test_sizes_default_to_a_hundred_runs_of_an_orbit():
    plan = plan_of(SuiteRequest("volpe2017", None, 1))
    assert plan.runs(plan.paper_case(), "best") == 100
    assert plan.paper_case().frames == 1166
    assert plan.parts == PARTS
    assert plan_of(SuiteRequest("volpe2017", None, 1, quick=True)).sizes == QUICK


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"parts": ("table9",)}, "--parts among paper, observability"),
        ({"runs": 0}, "--runs from 1 to 100000, got 0"),
        ({"duration_s": 20.0}, "--duration-s from 60"),
        ({"acquisitions": 5}, "no --acquisitions"),
    ],
)
def test_what_cannot_be_run_is_refused(asked, message):
    with pytest.raises(ScenarioError, match=message):
        plan_of(SuiteRequest("volpe2017", None, 1, **asked))


def drawn(runs=400, size=1.0):
    """Return runs whose last errors are Gaussian of a size, and ten times that at first."""
    rng = np.random.default_rng(0)
    errors = size * rng.standard_normal((runs, 2, len(COLUMNS)))
    errors[:, 0] *= 10.0
    for name in ("shape_m", "shape_scaled_m"):
        place = COLUMNS.index(name)
        errors[:, :, place] = np.abs(errors[:, :, place])
    no_time, points = np.zeros(2), np.zeros((12, 3))
    return Runs([Outcome({"errors": each, "points": points}, no_time) for each in errors])


def test_errors_of_the_bounds_size_hold_and_larger_ones_do_not():
    bound = np.full((1, len(shape_bound.COLUMNS)), np.sqrt(3.0))
    right = {end.quantity: end for end in against_bound(drawn(), bound)}
    wrong = {end.quantity: end for end in against_bound(drawn(size=1.3), bound)}
    assert right["position_m"].holds
    assert not wrong["position_m"].holds
    assert right["position_m"].error == pytest.approx(np.sqrt(3.0), rel=0.1)


def test_an_order_of_magnitude_is_one():
    row = {each.quantity: each for each in improvements(drawn())}["velocity_m_s"]
    assert row.orders == pytest.approx(1.0, abs=0.1)
    assert 0 < went_astray(drawn()) < 40


def test_the_papers_case_is_one_orbit():
    assert paper_case().duration_s == pytest.approx(5828.5, abs=1.0)
