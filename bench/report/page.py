"""Put the report together: one HTML file, everything in it, nothing fetched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import jinja2

from bench.report.explorer.data import explorer_data
from bench.report.explorer.inlined import Inlined, inlined, policy
from bench.report.filmstrip import HERO_WIDTH_PX, Picture, filmstrip, picture
from bench.report.given import report_input
from bench.report.parts import Card, ReportInput, Section, TitledTable
from bench.report.run_table import RunTable
from bench.report.table import TITLES, Table, check_table, lost_table, title_of
from models.atomic_file import sweep_beside, write_text
from models.camera import Camera

TEMPLATE = "page.html.jinja"


@dataclass(frozen=True)
class Page:
    """What stands on a page, in its order.

    Attributes
    ----------
    title : str
        Of the window.
    heading, lead : str
    label : str
        Of whom the cards are.
    cards : sequence of Card
    headline_title : str
    headline : Table
        Its terms are told at the end of the page.
    before, after, later : sequence of Section
        Before and after that table, and after the frames.
    facts : sequence of (str, str)
        What was run.
    hero : Picture or None
        The picture at the top.
    hero_words : str
    frames : sequence of Picture
    marks : str
        What is drawn on them.
    explained : bool
        Whether ``paper`` and ``best`` are told of.
    scenario : dict
        Its tables.
    explorer : Inlined or None
        What moves; without it the page has no script.
    """

    title: str
    heading: str
    lead: str
    label: str
    cards: Sequence[Card]
    headline_title: str
    headline: Table
    before: Sequence[Section] = ()
    after: Sequence[Section] = ()
    later: Sequence[Section] = ()
    facts: Sequence[tuple[str, str]] = ()
    hero: Picture | None = None
    hero_words: str = ""
    frames: Sequence[Picture] = ()
    marks: str = ""
    explained: bool = False
    scenario: dict[str, dict[str, Any]] = field(default_factory=dict)
    explorer: Inlined | None = None


def write_page(path: Path, page: Page) -> None:
    """Write a page, whole or not at all."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    allowed = policy(() if page.explorer is None else page.explorer.scripts)
    given = {**vars(page), "policy": allowed, "runs": _runs(page)}
    text = environment.get_template(TEMPLATE).render(given)
    sweep_beside(path)
    write_text(path, text)


def _runs(page: Page) -> list[tuple[RunTable, str]]:
    """Return the runs behind all cells, each with the table that it leads back to."""
    sections = (*page.before, *page.after, *page.later)
    tables = [page.headline, *(own.table for section in sections for own in section.tables)]
    found: dict[str, tuple[RunTable, str]] = {}
    for table in tables:
        for runs in table.behind.values():
            found.setdefault(runs.anchor, (runs, table.anchor))
    return list(found.values())


def write_report(folder: Path) -> Path:
    """Write ``report.html`` of a scored dataset.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    DatasetError
        If the dataset or its score is missing, they do not belong together, or a frame cannot be
        read.
    """
    path = folder / "report.html"
    write_page(path, _report(report_input(folder)))
    return path


def _report(given: ReportInput) -> Page:
    score, label, records, info = given.score, given.label, given.records, given.info
    chain, rows = records.chain, given.headline["per_frame"]
    parts = chain.report(given)
    checks = Section(
        "What was asked, and what came", tables=(TitledTable("asked", check_table(score)),)
    )
    lost = Section(
        "Frames without a pose",
        tables=(TitledTable("Frames without a pose", lost_table(score), wide=True),),
        nothing="None.",
    )
    first_s, last_s = (rows[place]["time_s"] for place in (0, -1))
    runs = f", {score['runs']} runs" if score["runs"] > 1 else ""
    return Page(
        title=f"{info.case}, Sun {info.sun}",
        heading=info.case,
        lead=f"{parts.lead}; {first_s:z.1f} to {last_s:z.1f} s{runs}",
        label=title_of(label),
        cards=parts.cards,
        headline_title="The pipelines on the same frames",
        headline=parts.headline,
        before=[*parts.before, *([] if checks.is_empty else [checks])],
        after=parts.after,
        later=[*parts.later, lost],
        facts=[
            ("case", f"{info.case}, Sun {info.sun}, target {info.target}"),
            *_optics(records.onboard.camera),
            *parts.facts.items(),
            ("runs", str(score["runs"])),
            *info.provenance.items(),
            ("dataset", f"sha256 {records.dataset.fingerprint()}"),
        ],
        hero=picture(records, parts.hero, HERO_WIDTH_PX),
        hero_words=parts.hero_words,
        frames=filmstrip(records, parts.shown),
        marks=". ".join(each.capitalize() for each in (chain.legend, chain.greys) if each),
        explained=set(TITLES) <= set(score["pipelines"]),
        scenario=given.scenario,
        explorer=inlined(explorer_data(given, parts)),
    )


def _optics(camera: Camera | None) -> list[tuple[str, str]]:
    if camera is None:
        return []
    told = (
        f"{camera.width} × {camera.height} px, focal length {camera.fx:.2f} × {camera.fy:.2f} px, "
        f"principal point ({camera.cx:.2f}, {camera.cy:.2f})"
    )
    return [("camera", told)]
