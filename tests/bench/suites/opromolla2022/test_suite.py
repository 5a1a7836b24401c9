"""The suite over painted frames: the same bytes however it is run, and numbers that make sense."""

import io
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from bench.suites.opromolla2022.cases import APPROACH, BY_NAME, SEQUENCES, published
from bench.suites.opromolla2022.frame_file import frame_path, read_frame
from bench.suites.opromolla2022.plan import PARTS, QUICK, Plan, Sizes
from bench.suites.opromolla2022.results import Outcomes
from bench.suites.opromolla2022.suite import plan_of, run_plan
from bench.suites.request import SuiteRequest
from models.errors import DatasetError, ScenarioError
from tests.support.painted_flight import paint_approach

TWO_FRAMES_HZ = 0.00304  # at 0 s and at 329 s
SIZES = Sizes(
    runs=6, seeds=2, rates_hz=tuple((key, TWO_FRAMES_HZ) for key, _ in QUICK.rates_hz), width=512
)
PARTS_HERE = ("S7", "M1")
QUIET = Console(file=io.StringIO())


@pytest.fixture(scope="module")
def painted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a suite's folder that holds the frames of S7, and nothing flown."""
    out = tmp_path_factory.mktemp("painted")
    paint_approach(Plan(SIZES, out, PARTS_HERE), "S7")
    return out


@pytest.fixture(scope="module")
def flown(painted: Path, tmp_path_factory: pytest.TempPathFactory) -> Plan:
    """Return a plan that was flown by two workers."""
    out = tmp_path_factory.mktemp("flown") / "suite"
    shutil.copytree(painted, out)
    plan = Plan(SIZES, out, PARTS_HERE)
    run_plan(plan, 2, None, 1e9, QUIET)
    return plan


@pytest.mark.slow
def test_one_worker_and_a_stop_in_between_give_the_same_bytes(flown: Plan, tmp_path: Path) -> None:
    out = tmp_path / "again"
    shutil.copytree(flown.out / "frames", out / "frames")
    shutil.copytree(flown.out / "units", out / "units")
    left = sorted((out / "units").rglob("*.npz"))
    assert len(left) == 2  # six runs, five in a unit
    left[0].unlink()
    run_plan(Plan(SIZES, out, PARTS_HERE), 1, None, 1e9, QUIET)
    assert (out / "suite.json").read_bytes() == (flown.out / "suite.json").read_bytes()
    assert sorted(p.read_bytes() for p in (out / "units").rglob("*.npz")) == sorted(
        p.read_bytes() for p in (flown.out / "units").rglob("*.npz")
    )


def test_what_is_flown_needs_no_frames_any_more(flown: Plan, tmp_path: Path) -> None:
    out = tmp_path / "without"
    shutil.copytree(flown.out / "units", out / "units")
    run_plan(Plan(SIZES, out, PARTS_HERE), 1, None, 1e9, QUIET)
    assert (out / "suite.json").read_bytes() == (flown.out / "suite.json").read_bytes()


def test_errors_are_those_of_the_draws(flown: Plan) -> None:
    """A calibration that is off moves poses, run by run; who knows its sigmas is nearer.

    The first frame: the target is 5 m nearer in the one after it, which none foresees.
    """
    outcomes = Outcomes(flown, flown.out / "units")
    own = BY_NAME["S7"]
    flights = (outcomes.runs(own, variant).errors for variant in ("best", "paper", "exact"))
    best, paper, exact = flights
    assert best.shape == exact.shape == (6, 2, 6)
    assert np.isfinite(exact).all()
    assert np.isfinite(best[:, 0]).all()
    assert np.abs(exact[..., :3]).max() > 3e-4
    for axis in (0, 1):
        # Markers weighed alike: the centroids' own 0.1 px are a millimetre, the draws' three.
        assert np.corrcoef(paper[:, 0, axis], exact[:, 0, axis])[0, 1] > 0.9
    assert (best[:, 0, :2] ** 2).sum() < 0.8 * (exact[:, 0, :2] ** 2).sum()
    moved = outcomes.runs(BY_NAME["M1"], "exact").errors
    assert np.abs(moved - exact).max() > 1e-4


def test_runs_differ_in_their_noise_and_variants_share_it(flown: Plan) -> None:
    centroids = Outcomes(flown, flown.out / "units").runs(BY_NAME["S7"], "best").of("centroids")
    first = centroids[:, 0]
    there = np.isfinite(first).all(axis=(0, 2))
    assert there.sum() >= 6
    spread = first[:, there].std(axis=0)
    assert (spread > 1e-5).all()
    assert spread.mean() < 0.05  # px, of discs of one to four pixels


def test_the_page_opens_by_itself_and_says_what_is_shared(flown: Plan) -> None:
    text = (flown.out / "suite.html").read_text()
    assert "http://" not in text.replace("http://www.w3.org", "")
    for words in ("Table 12", "Table 16", "share its rendered frames", "exact centroids"):
        assert words in text
    found = json.loads((flown.out / "suite.json").read_text())
    names = [own["sequence"]["name"] for own in found["parts"]["sequences"]]
    assert names == ["S7", "M1"]


def test_a_frame_reads_back_as_it_was_and_a_cut_one_is_refused(painted: Path) -> None:
    path = frame_path(Plan(SIZES, painted, PARTS_HERE).folder(APPROACH), "S7", 0)
    frame = read_frame(path)
    assert frame.images[850].shape == (512, 512)
    assert [len(each) for each in frame.windows.values()] == [10, 10]
    window = next(each for each in frame.windows[850] if each is not None)
    assert window.lamps["lamps_850"].max() > 0.0 == window.others.max()
    cut = painted / "cut.npz"
    cut.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(DatasetError, match="delete it and run the same suite again"):
        read_frame(cut)


def test_every_printed_table_has_its_sequences() -> None:
    printed = published()["results"]
    assert {own.name for own in SEQUENCES if own.table} == set(printed)
    assert len(SEQUENCES) == 11 + 5 + 36


def test_parts_are_groups_or_names(tmp_path: Path) -> None:
    names = [own.name for own in Plan(QUICK, tmp_path, ("hand", "S2")).sequences]
    assert names == ["S2", "E-SB", "E-I", "E-C1", "E-C2", "E-M1"]
    assert Plan(QUICK, tmp_path, ("sensitivity", "S2")).studied == ["S2"]
    assert len(Plan(QUICK, tmp_path, PARTS).sequences) == len(SEQUENCES)
    with pytest.raises(ScenarioError, match="sequences such as S2"):
        Plan(QUICK, tmp_path, ("S9",))


def test_sizes_are_asked_for_by_option(tmp_path: Path) -> None:
    request = SuiteRequest("opromolla2022", tmp_path, 1, quick=True, runs=2, rate_hz=0.5)
    plan = plan_of(request)
    assert plan.sizes.runs == 2
    assert {rate for _, rate in plan.sizes.rates_hz} == {0.5}
    assert plan.sizes.width == QUICK.width
    with pytest.raises(ScenarioError, match="--acquisitions"):
        plan_of(SuiteRequest("opromolla2022", tmp_path, 1, acquisitions=3))


def test_the_price_is_of_what_is_left(painted: Path) -> None:
    plan = Plan(SIZES, painted, (*PARTS_HERE, "S2"))
    price = plan.price(plan.flights)
    assert price.frames == 2  # of S2: those of S7 are there
    assert price.render_s > 0.0 < price.size_gb
