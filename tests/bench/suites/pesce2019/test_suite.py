"""The whole suite, tiny and with a stand-in for the pipeline: the same bits, however it is run."""

import io
import json
import shutil
from collections import Counter
from dataclasses import replace

import pytest
from rich.console import Console

from bench.suites.pesce2019.cases import case, published
from bench.suites.pesce2019.comparison import Measured, compared, why_tracking
from bench.suites.pesce2019.plan import PARTS, QUICK, Plan, Sizes
from bench.suites.pesce2019.results import Outcomes
from bench.suites.pesce2019.suite import plan_of, run_plan, without_times
from bench.suites.pesce2019.suite_tables import standing
from bench.suites.request import SuiteRequest
from bench.suites.units import outcome_path
from models.errors import ScenarioError

STAND_IN = "tests.support.stand_in_navigation"
SIZES = Sizes(runs=1, acquisitions=2, seeds=1, duration_s=60.0)
PLAN = Plan(SIZES, ("table5", "table7"), navigator=STAND_IN)
QUIET = Console(file=io.StringIO())


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    out = tmp_path_factory.mktemp("suite") / "out"
    run_plan(PLAN, out, 1, QUIET)
    return out


def document(out) -> object:
    return without_times(json.loads((out / "suite.json").read_text()))


@pytest.mark.slow
def test_two_workers_after_a_stop_write_the_same(done, tmp_path):
    """Every sixth unit is taken away, in no order that a run would leave, and done again."""
    out = tmp_path / "out"
    shutil.copytree(done, out)
    units = PLAN.units()
    for unit in units[::6]:
        outcome_path(out / "units", unit).unlink()
    run_plan(PLAN, out, 2, QUIET)
    assert document(out) == document(done)
    for unit in units:
        one, other = (outcome_path(folder / "units", unit) for folder in (done, out))
        assert one.read_bytes() == other.read_bytes()


def test_every_cell_asked_for_is_there(done):
    cells = json.loads((done / "suite.json").read_text())["cells"]
    assert sum(cell["table"] == "table5" for cell in cells) == 3 * 4
    assert sum(cell["table"] == "table7" for cell in cells) == 5 * 2
    assert {cell["table"] for cell in cells} == {"table5", "table7"}
    for cell in cells:
        far = cell["paper_verdict"] in ("worse by more", "better by more", "none")
        assert far == (cell["explanation"] is not None)


def test_cells_stand_beside_the_papers_own_figures(done):
    cells = json.loads((done / "suite.json").read_text())["cells"]
    row = {(c["row"], c["quantity"]): c["published"] for c in cells if c["table"] == "table7"}
    assert row["σ 4 px", "position rmse"] == 0.0735
    assert row["σ 4 px", "attitude rmse"] == 0.943
    found = {(c["row"], c["quantity"]): c["published"] for c in cells if c["table"] == "table5"}
    assert found["case 3, LEO Mix", "attitude error, mean"] == 1.474


def test_the_page_opens_offline_and_has_its_figures(done):
    text = (done / "suite.html").read_text()
    assert "://" not in text.replace("http://www.w3.org", "")  # base64 has no colon
    assert text.count("data:image/svg+xml;base64,") == 1  # acquisitions; Table 6 was not asked for
    assert "Table 7: noise" in text
    assert "Table 8: outliers" not in text


def test_more_of_the_same_goes_on_from_what_is_there(done, tmp_path):
    out = tmp_path / "out"
    shutil.copytree(done, out)
    said = io.StringIO()
    run_plan(replace(PLAN, parts=("table7",)), out, 1, Console(file=said, width=200))
    assert said.getvalue() == ""  # nothing to do
    assert {c["table"] for c in json.loads((out / "suite.json").read_text())["cells"]} == {"table7"}


def test_runs_that_tables_share_are_done_once():
    plan = Plan(replace(SIZES, runs=3, seeds=2), PARTS, navigator=STAND_IN)
    units = plan.units()
    assert len({unit.name for unit in units}) == len(units)
    tracking = [unit for unit in units if unit.kind.startswith("tracking")]
    # Five cases of three; nine cells of two, of which 2 px and one outlier are case 1's own.
    assert len(tracking) == 2 * (5 * 3 + (4 + 4) * 2 + 2)
    bounds = [unit for unit in units if unit.kind == "bound"]
    assert len(bounds) == 5 + 4 + 1  # outliers change none


def test_both_variants_get_the_same_points():
    for unit in PLAN.units():
        if unit.kind.endswith(", best"):
            twin = unit.name.replace("/best/", "/paper/")
            other = next(each for each in PLAN.units() if each.name == twin)
            assert replace(unit.task, variant="", options="") == replace(
                other.task, variant="", options=""
            )


def test_sizes_default_to_the_papers():
    noise = published()["noise"]
    plan = plan_of(SuiteRequest("pesce2019", None, 1))
    assert plan.sizes.runs == noise["tracking"]["runs"]
    assert plan.sizes.frames == noise["tracking"]["duration_s"] * noise["tracking"]["rate_hz"]
    assert plan.sizes.acquisitions == 1000
    assert plan.parts == PARTS
    assert plan_of(SuiteRequest("pesce2019", None, 1, quick=True)).sizes == QUICK
    asked = SuiteRequest("pesce2019", None, 1, runs=7, duration_s=90.0, parts=("vinag",), seed=4)
    assert plan_of(asked).sizes == Sizes(runs=7, duration_s=90.0, seed=4)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"parts": ("table9",)}, "--parts among table5, table6"),
        ({"runs": 0}, "--runs from 1 to 100000, got 0"),
        ({"duration_s": 20.0}, "--duration-s from 60"),
        ({"duration_s": float("nan")}, "--duration-s from 60"),
    ],
)
def test_what_cannot_be_run_is_refused(asked, message):
    with pytest.raises(ScenarioError, match=message):
        plan_of(SuiteRequest("pesce2019", None, 1, **asked))


def test_cases_are_those_of_table_4():
    assert case("3").omega_t0_deg_s == (0.5, -0.3, 0.2)
    assert case("4").rho_dot0_m_s == (3e-3, -1e-3, 0.0)
    assert case("5").target == "hispasat"
    assert case("vinag").orbit.e == 0.0


def test_a_figure_is_explained_by_what_weighs_most():
    even = Measured("m", 0.03, 0.09, 0.03, 0.1, 0.045, 0.004, 0.0, 0.0, runs=50)
    text = why_tracking(even, 0.01)
    assert "0.0900 m rms, 2.0 times the Cramér–Rao bound" in text
    assert "divides that by 3.00" in text
    assert "would take a division by 9.00" in text
    one_run = replace(even, worst_share=0.9, median_run=0.011)
    assert why_tracking(one_run, 0.01).startswith("One run makes 90 % of the sum of squares")
    assert not why_tracking(replace(one_run, runs=1), 0.01).startswith("One run")
    better = why_tracking(replace(even, filtered=0.004), 0.01)
    assert "the published figure is 0.22 times the bound of one image" in better
    assert "No state in 100 % of the frames" in why_tracking(
        replace(even, filtered=None, raw=None, no_state=1.0), 0.01
    )


def test_a_filter_stands_between_its_poses_and_its_bound():
    assert standing(0.1, 0.02, 0.01, 50) == "between"
    assert standing(0.1, 0.12, 0.01, 50) == "no better than the pose"
    assert standing(0.1, 0.005, 0.01, 50) == "below its bound"
    assert standing(0.1, 0.008, 0.01, 4) == "at its bound"  # of four runs, by chance
    assert standing(0.1, 0.008, 0.01, 50) == "below its bound"
    assert standing(None, 0.008, 0.01, 50) == "–"


def test_outcomes_of_another_plan_are_not_taken(done):
    other = Outcomes(replace(PLAN, sizes=replace(SIZES, seed=1)), done / "units")
    with pytest.raises(Exception, match="run the same suite again"):
        compared(other.results())


def test_the_paper_variant_may_be_given_fewer_runs_and_best_keeps_its_own() -> None:
    def tally(paper_runs: int | None) -> Counter[str]:
        sizes = Sizes(runs=6, acquisitions=40, seeds=3, paper_runs=paper_runs)
        units = Plan(sizes, ("table5", "table6")).units()
        return Counter(unit.kind for unit in units)

    whole, fewer = tally(None), tally(2)
    assert whole["tracking, paper"] == whole["tracking, best"] == fewer["tracking, best"] == 30
    assert fewer["tracking, paper"] == 10
    assert fewer["acquisition, paper"] < whole["acquisition, paper"]
    assert fewer["acquisition, best"] == whole["acquisition, best"]
    with pytest.raises(ScenarioError, match="--paper-runs"):
        Sizes(paper_runs=0)
