"""The whole suite, tiny: every part, killed and gone on with, the same numbers each time."""

import io
import json
import re
import shutil
import subprocess
import sys

import pytest
from rich.console import Console

from bench.suites.pesce2019.suite import without_times
from bench.suites.request import SuiteRequest
from bench.suites.units import outcome_path
from bench.suites.vinag2018.cases import GEO, LEO, published
from bench.suites.vinag2018.plan import PARTS, QUICK, Plan, Sizes
from bench.suites.vinag2018.suite import plan_of, run_plan
from models.errors import ScenarioError
from models.gnss.range_errors import RangeErrors
from models.gnss.receiver_clock import ReceiverClock
from tests.support.patience import HANGS_S

PLAN = Plan(
    Sizes(runs=2, seeds=1, duration_s=60.0, star_rate_hz=1),
    ("leo", "model", "faults", "mask", "geo"),
)
FALSE_ALARMS = 1e-3  # beyond five sigmas falls one in two million; as many as some thousands tell
FAULT_RUNS = 1
SHORT_FAULT_S = 520.0  # the lie, from 200 s to 500 s, is in it
QUIET = Console(file=io.StringIO())


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    out = tmp_path_factory.mktemp("suite") / "out"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("bench.suites.vinag2018.plan.FAULT_S", SHORT_FAULT_S)
        run_plan(PLAN, out, 1, QUIET)
        yield out


def document(out) -> object:
    return without_times(json.loads((out / "suite.json").read_text()))


@pytest.mark.slow
def test_after_a_stop_it_writes_the_same(done, tmp_path):
    out = tmp_path / "out"
    shutil.copytree(done, out)
    units = PLAN.units()
    for unit in units[::5]:
        outcome_path(out / "units", unit).unlink()
    run_plan(PLAN, out, 1, QUIET)
    assert document(out) == document(done)


def test_every_part_asked_for_is_there(done):
    parts = document(done)["parts"]
    assert {name: len(cells) for name, cells in parts["flights"].items()} == {
        "leo": 2,
        "model": 4,
        "mask": 2,
        "geo": 2,
    }
    assert len(parts["faults"]) == 3
    assert parts["counted"] == []
    assert parts["sampled"] is None


def test_diagnostics_are_counted(done):
    found = document(done)["parts"]["diagnosed"]
    assert [each["cell"]["fault"] != "" for each in found] == [False] * 4 + [True] * 3
    for each in found:
        assert each["ranges"] > 0
        assert each["edited_healthy"] <= FALSE_ALARMS
        assert each["stars_refused"] <= FALSE_ALARMS
        assert each["beyond"] == 0.0
    lied = found[4]
    assert lied["lies"] == FAULT_RUNS * 300
    assert lied["lies_used"] <= FALSE_ALARMS
    assert lied["named_healthy"] == 0


def test_the_page_opens_offline_and_has_its_figures(done):
    text = (done / "suite.html").read_text()
    assert not re.search("https?:", text.replace("http://www.w3.org", ""))
    assert text.count("data:image/svg+xml;base64,") == 7  # three an orbit, and the faults
    for title in ("LEO: Figure 5 and Figure 6", "GEO: Figure 7 and Figure 8", "Faults"):
        assert title in text
    assert "below 3.00 m" in text
    assert "Figures 9 and 10" not in text


def test_what_is_flown_is_the_papers():
    told = published()
    assert told["orbits"]["leo"]["a_km"] == LEO.axis_km
    assert told["orbits"]["leo"]["i_deg"] == LEO.inclination_deg
    assert pytest.approx(GEO.axis_km - 6378.137) == told["orbits"]["geo"]["pericentre_height_km"]
    for case in (LEO, GEO):
        assert case.sensitivity_dbhz == told["sensitivity_dbhz"][case.key]
    errors, clock = RangeErrors(), ReceiverClock()
    assert told["range_errors_m"] == {
        "broadcast_clock": errors.clock_m,
        "broadcast_ephemeris": errors.ephemeris_m,
        "ionosphere_below_1000_km": LEO.ionosphere_m,
        "multipath": errors.multipath_m,
    }
    assert told["clock"] == {"bias_ms": 1e3 * clock.bias_s, "drift_us_s": 1e6 * clock.drift}


def test_sizes_default_to_the_papers():
    plan = plan_of(SuiteRequest("vinag2018", None, 1))
    assert plan.sizes.runs == 50
    assert plan.sizes.acquisitions == 1000
    assert plan.parts == PARTS
    assert plan.sizes.span_s(LEO) == pytest.approx(6027.0, abs=1.0)
    assert plan.sizes.span_s(GEO) == pytest.approx(86_821.0, abs=5.0)
    assert plan_of(SuiteRequest("vinag2018", None, 1, quick=True)).sizes == QUICK


def test_star_frames_come_as_often_as_is_asked():
    assert plan_of(SuiteRequest("vinag2018", None, 1, rate_hz=2.0)).sizes.star_rate_hz == 2
    with pytest.raises(ScenarioError, match="expected --rate-hz, star frames a second, among 1, 2"):
        plan_of(SuiteRequest("vinag2018", None, 1, rate_hz=3.0))


def test_units_are_named_once_and_all_parts_have_some():
    units = Plan(Sizes(runs=20), PARTS).units()
    assert len({unit.name for unit in units}) == len(units)
    for part in set(PARTS) - {"dataset"}:
        assert Plan(Sizes(), (part,)).units()


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"parts": ("table5",)}, "--parts among leo, geo"),
        ({"runs": 0}, "--runs from 1 to 100000, got 0"),
        ({"duration_s": 20.0}, "--duration-s from 60"),
        ({"paper_runs": 5}, "no --paper-runs with vinag2018"),
        ({"acquisitions": 0}, "--acquisitions from 1 to 100000, got 0"),
    ],
)
def test_what_cannot_be_run_is_refused(asked, message):
    with pytest.raises(ScenarioError, match=message):
        plan_of(SuiteRequest("vinag2018", None, 1, **asked))


def test_no_renderer_is_loaded():
    code = (
        "import sys, bench.suites.vinag2018.suite; "
        "sys.exit(any(name in sys.modules for name in ('mitsuba', 'drjit')))"
    )
    assert (
        subprocess.run([sys.executable, "-c", code], timeout=HANGS_S, check=False).returncode == 0
    )
