"""The report holds what it must, opens offline, and knows what it has no number for."""

import io
import re
import shutil
from html.parser import HTMLParser

import numpy as np
import pytest
from rich.console import Console

from bench import api
from bench.report.explorer.inlined import HERE as EXPLORER
from bench.report.explorer.inlined import LIBRARIES
from bench.report.filmstrip import MOST_FRAMES, chosen
from bench.report.numbers import number, numbers, share
from bench.report.pairs.tables import TERMS, at_the_bound, headline_table
from bench.report.summary import print_table
from bench.report.table import Table, without_pose
from bench.report.time_plot import size_plots
from models.errors import DatasetError
from tests.support.synthetic_dataset import (
    lost_estimate,
    perfect_estimate,
    write_dataset,
    write_variant,
)

LARGEST_BYTES = 6_000_000
DRAWS = 20_000
QUANTILES_WITHIN = 0.03  # of so many draws, four sigma of the widest
REFERENCES = {"src", "href", "srcset", "data", "action", "poster", "background"}


class Page(HTMLParser):
    """What a browser would fetch, and the text that a reader sees."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.tags: list[str] = []
        self.words: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.fetched += [value for key, value in attrs if key in REFERENCES and value]

    def handle_data(self, data):
        if self.tags[-1:] not in (["style"], ["script"]):
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


@pytest.fixture(scope="module")
def page(scored_dataset) -> Page:
    return Page((scored_dataset.folder / "report.html").read_text())


def test_nothing_is_fetched(page, scored_dataset):
    assert page.fetched
    assert all(address.startswith(("data:", "#")) for address in page.fetched)
    assert {"link", "iframe", "object", "embed", "base"}.isdisjoint(page.tags)
    text = (scored_dataset.folder / "report.html").read_text()
    for library in LIBRARIES:
        text = text.replace((EXPLORER / library).read_text(), "")
    assert not re.search(r"@import|url\(\s*['\"]?(?!data:)", text)
    assert "http://" not in text
    assert "https://" not in text


def test_it_is_small(scored_dataset):
    assert (scored_dataset.folder / "report.html").stat().st_size < LARGEST_BYTES


@pytest.mark.parametrize(
    "part",
    [
        "maxar1300 under Sun S2",
        "4 image pairs of 512 × 512",
        "The pipelines on the same frames",
        "paper variant",
        "Beside the paper",
        "Opromolla et al. 2022, 100 runs",
        "are statistics of the mean error over the runs",
        "Pose error against time",
        "Centroid error against time",
        "Markers",
        "Frames without a pose None.",
        "By range",
        "What was run",
        "sha256",
        "asinh",
        "What each number means",
    ],
)
def test_parts(page, part):
    assert part.lower() in page.text.lower()


def test_every_term_is_explained(page):
    for term in TERMS:
        assert page.text.count(term.name) >= 2
        assert term.meaning in page.text


def test_pictures(page):
    pictures = [address for address in page.fetched if address.startswith("data:image/jpeg")]
    figures = [address for address in page.fetched if address.startswith("data:image/svg")]
    assert len(pictures) == 1 + 4  # the large one, and the filmstrip
    assert len(figures) == 3


def test_the_papers_numbers_stand_beside_ours(page):
    """Table 12, S2: sigma_N of tz is 0.056 cm; Table 13: centroids 0.075 px in u."""
    assert "0.56" in page.text
    assert "0.0750" in page.text


def test_the_same_score_gives_the_same_bytes(scored_dataset):
    path = scored_dataset.folder / "report.html"
    before = path.read_bytes()
    api.report(scored_dataset.folder)
    assert path.read_bytes() == before


def test_lost_frames_and_a_sun_of_no_paper(tmp_path):
    """A dataset with nothing but lost frames still has a report; unknown numbers are dashes."""
    dataset = write_dataset(tmp_path / "data", frames=2, sun="0,0,1", width_px=128)
    write_variant(dataset, "best", lambda truth: lost_estimate(truth, "blinded by <the Sun>"))
    api.score(dataset.folder)
    page = Page(api.report(dataset.folder).read_text())
    assert "0 of 2" in page.text
    assert "2 missed" in page.text
    assert "best 2 0, 1 blinded by <the Sun>" in page.text
    assert "No paper reports this Sun" in page.text


def test_frames_that_could_not_be_seen_are_told_beside_those_missed(tmp_path):
    """Every frame stands in some row: with a pose, missed, or with too few markers to be seen."""
    dataset = write_dataset(tmp_path / "data", frames=3, width_px=128)
    write_variant(dataset, "best", lambda truth: lost_estimate(truth, "too few"))
    score = api.score(dataset.folder)
    own = score["pipelines"]["best"]
    own["core"]["lost"]["missed"] = 1
    rows = {row[0]: row[1] for row in headline_table(score).rows}
    named = ("with a pose", "without a pose", "missed", "could not be seen")
    assert [rows[name] for name in named] == ["0", "3", "1", "2"]
    assert without_pose(own["core"]) == "3 (1 missed, 2 could not be seen)"


@pytest.mark.parametrize("poses", [1, 5, 40])
def test_so_few_poses_leave_a_ratio_to_the_bound_to_chance(poses):
    """Against draws: one number a pose, normal, over its own sigma."""
    errors = np.random.default_rng(3).standard_normal((DRAWS, poses))
    ratios = np.sqrt((errors**2).mean(axis=1))
    drawn = np.quantile(ratios, (0.025, 0.975))
    assert at_the_bound(poses) == pytest.approx(drawn, abs=QUANTILES_WITHIN)


def test_one_frame_and_one_variant(tmp_path):
    dataset = write_dataset(tmp_path / "data", frames=1, width_px=128)
    write_variant(dataset, "paper", perfect_estimate)
    api.score(dataset.folder)
    assert "1 of 1" in Page(api.report(dataset.folder).read_text()).text


def test_a_report_wants_a_score(scored_dataset, tmp_path):
    copy = tmp_path / "copy"
    shutil.copytree(scored_dataset.folder, copy)
    (copy / "score.json").unlink()
    with pytest.raises(DatasetError, match="run `rvbench score"):
        api.report(copy)


@pytest.mark.parametrize(
    ("frames", "wanted"), [(0, []), (1, []), (3, [1]), (12, []), (100, []), (100, [50, 51])]
)
def test_the_filmstrip_holds_the_ends_and_what_is_wanted(frames, wanted):
    strip = chosen(list(range(frames)), wanted)
    assert strip == sorted(set(strip))
    assert len(strip) == min(frames, MOST_FRAMES)
    assert set(wanted) <= set(strip)
    assert {0, frames - 1} <= set(strip) or frames == 0


def test_the_filmstrip_is_spread_evenly():
    assert set(np.diff(chosen(list(range(100)), []))) == {9}


def test_many_lost_frames_leave_room_for_others():
    strip = chosen(list(range(100)), list(range(40, 60)))
    assert len(strip) == MOST_FRAMES
    assert strip[0] == 0
    assert strip[-1] == 99


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.012345, "0.0123"),
        (1.0, "1.00"),
        (0.99996, "1.00"),
        (-3.14159, "−3.14"),
        (1234.5, "1234"),
        (0.0, "0"),
        (None, "–"),
        (9.999e-8, "1.00e−7"),
        (-2.61e-6, "−2.61e−6"),
        (1.00001e-5, "0.0000100"),
        (5e-324, "4.94e−324"),
    ],
)
def test_numbers(value, text):
    assert number(value) == text


def test_numbers_in_a_row():
    assert numbers([1.0, -2.0, 3.0], 2, signed=True) == ["+1.0", "−2.0", "+3.0"]
    assert numbers([1e-6, -1e-6, 0.0], signed=True) == ["+1.00e−6", "−1.00e−6", "0"]
    assert numbers(None) == ["–", "–", "–"]
    assert share(0.98765) == "98.8 %"
    assert share(0.9997) == "99.97 %"  # not all of them
    assert share(1.0) == "100 %"
    assert share(None) == "–"


@pytest.mark.parametrize(
    ("errors_mm", "unit"), [([2.0, None, 3.0], "mm"), ([900.0, 2e3, 3e3], "m")]
)
def test_a_position_error_of_metres_is_plotted_in_metres(errors_mm, unit):
    rows = [{"position_error_mm": each, "attitude_error_deg": 0.1} for each in errors_mm]
    position, _ = size_plots({"pipelines": {"best": {"per_frame": rows}}})
    assert position.unit == unit
    in_mm = {"mm": 1.0, "m": 1e3}[unit]
    values = [None if each is None else each * in_mm for each in position.lines[0].values]
    assert values == pytest.approx(errors_mm)


@pytest.mark.parametrize("width", [44, 60, 80, 200])
def test_a_narrow_terminal_breaks_no_numbers_apart(width):
    """What does not fit side by side comes below; every cell is whole, in one line."""
    cells = ["0.00884, 0.00258, 0.0283 mm", "−0.0189 (−0.0566 to 0)", "0.174 mm"]
    rows = [["position rms", *cells], ["NEES", *reversed(cells)]]
    stream = io.StringIO()
    print_table(Console(file=stream, width=width), Table(["", *"abc"], rows, {}, {}), "title")
    told = stream.getvalue()
    assert all(told.count(cell) == 2 for cell in cells)
    assert max(map(len, told.splitlines())) <= width
    assert told.count("position rms") == {44: 3, 60: 3, 80: 2, 200: 1}[width]
