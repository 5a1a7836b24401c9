"""A table of text for a report or a terminal, and the rows that every chain's tables begin with."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from bench.report.numbers import NONE, count, number, share
from bench.scoring.judgement import without_numbers
from bench.scoring.score import shown_labels

if TYPE_CHECKING:  # it is made of tables itself
    from bench.report.run_table import RunTable

Score = dict[str, Any]
MOST_LISTED = 10
TITLES = {"best": "best", "paper": "paper variant"}


@dataclass(frozen=True)
class Table:
    """A table of text.

    Attributes
    ----------
    head : list of str
        Column titles; the first column's is usually empty.
    rows : list of list of str
    terms : dict
        What a first cell means, by its text: shown when pointed at.
    sections : dict
        Titles that stand before the row of a given number.
    behind : mapping of (int, int) to RunTable
        The runs that a cell is of, by row and column.
    """

    head: list[str]
    rows: list[list[str]]
    terms: dict[str, str]
    sections: dict[int, str]
    behind: Mapping[tuple[int, int], RunTable] = field(default_factory=dict)

    @property
    def anchor(self) -> str:
        """Where it stands in a page; empty where nothing leads back to it."""
        told = repr((self.head, self.rows, self.sections)).encode()
        return f"table-{hashlib.sha256(told).hexdigest()[:12]}" if self.behind else ""


@dataclass(frozen=True)
class Term:
    """A row of the headline table.

    Attributes
    ----------
    name, meaning : str
    section : str
        Title of the section that begins with it, if one does.
    """

    name: str
    meaning: str
    section: str = ""


CORE_TERMS = (
    Term("frames", "Frames in the dataset.", "frames"),
    Term("with a pose", "Frames with a pose that the pipeline stands by."),
    Term(
        "without a pose",
        "All others: missed, where they should have given one, or not to be had, as where too few "
        "markers are whole, lit and in the image, or nothing had been acquired yet.",
    ),
    Term("missed", "Frames whose own readings gave no pose although they should have."),
    Term(
        "wrong poses",
        "Poses whose error is beyond what their covariance allows, and beyond the case's limits; "
        "in brackets most of them in a row. None of these should be.",
    ),
    Term("position error, median", "Length of estimate minus truth, run 0.", "pose"),
    Term("position error, p95", "95 of 100 frames are better than this."),
    Term("attitude error, median", "Angle of the turn between estimated and true attitude."),
    Term("attitude error, p95", "95 of 100 frames are better than this."),
)
TIME_TERMS = (
    Term("runtime, median", "Time a frame takes, run 0, on the machine that estimated.", "time"),
    Term("runtime, p95", "95 of 100 frames take less."),
)


def core_cells(core: dict[str, Any]) -> list[str]:
    """Return one pipeline's cells of ``CORE_TERMS``."""
    position, attitude, wrong = (
        core["position_error_mm"],
        core["attitude_error_deg"],
        core["wrong"],
    )
    return [
        count(core["frames"]),
        count(core["estimated"]),
        count(core["frames"] - core["estimated"]),
        count(core["lost"]["missed"]),
        f"{wrong['count']} ({wrong['longest']})" if wrong["count"] else count(0),
        length(position["median"]),
        length(position["p95"]),
        with_unit(attitude["median"], "deg"),
        with_unit(attitude["p95"], "deg"),
    ]


def without_pose(core: dict[str, Any]) -> str:
    """Tell of the frames of markers that have no pose which were missed and which not."""
    without, missed = core["frames"] - core["estimated"], core["lost"]["missed"]
    return f"{without} ({missed} missed, {unseen(core)} could not be seen)" if without else "0"


def unseen(core: dict[str, Any]) -> str:
    """Count the frames of markers that have no pose and were not missed."""
    return count(core["frames"] - core["estimated"] - core["lost"]["missed"])


def time_cells(core: dict[str, Any]) -> list[str]:
    """Return one pipeline's cells of ``TIME_TERMS``."""
    runtime = core["runtime_ms"]
    return [with_unit(runtime["median"], "ms"), with_unit(runtime["p95"], "ms")]


def headline(score: Score, terms: Sequence[Term], columns: dict[str, list[str]]) -> Table:
    """Compare the pipelines on the same frames.

    Parameters
    ----------
    score : dict
    terms : sequence of Term
        By row.
    columns : dict of str to list of str
        Cells by pipeline.
    """
    labels = shown_labels(score)
    rows = [
        [term.name, *(columns[label][place] for label in labels)]
        for place, term in enumerate(terms)
    ]
    sections = {place: term.section for place, term in enumerate(terms) if term.section}
    head = ["", *(title_of(label) for label in labels)]
    return Table(head, rows, {term.name: term.meaning for term in terms}, sections)


def lost_table(score: Score) -> Table:
    """List why frames have no pose, and which they are."""
    rows = []
    for label in shown_labels(score):
        own = score["pipelines"][label]
        for reason, times in own["core"]["lost"]["reasons"].items():
            which = [
                count(row["frame"])
                for row in own["per_frame"]
                if row["reason"] is not None and without_numbers(row["reason"]) == reason
            ]
            shown = ", ".join(which[:MOST_LISTED]) + (" ..." if len(which) > MOST_LISTED else "")
            rows.append([title_of(label), count(times), shown, reason])
    return Table(["pipeline", "frames", "which", "reason"], rows, {}, {})


def check_table(score: Score) -> Table:
    """Set what the case asks for beside what was measured."""
    holds = {True: "holds", False: "does not hold", None: "nothing to judge"}
    rows = [
        [
            title_of(label),
            check["what"],
            check["asked"],
            share(check["measured"]) if check["unit"] == "%" else number(check["measured"]),
            holds[check["holds"]],
        ]
        for label in shown_labels(score)
        for check in score["pipelines"][label]["parts"].get("asked") or []
    ]
    return Table(["pipeline", "what", "asked", "measured", ""], rows, {}, {})


def title_of(label: str) -> str:
    """Return what a pipeline is called."""
    return TITLES.get(label, label)


def with_unit(value: float | None, unit: str) -> str:
    """Write a number with its unit, or a dash."""
    return NONE if value is None else f"{number(value)} {unit}"


def length(value_mm: float | None) -> str:
    """Write a length with the unit that suits it."""
    if value_mm is None or value_mm < 1000.0:
        return with_unit(value_mm, "mm")
    return with_unit(1e-3 * value_mm, "m")
