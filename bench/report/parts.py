"""What a chain gives to its report: numbers at the top, a picture, and sections in order."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from bench.pictures.frame_record import FrameRecords
from bench.report.table import Table
from bench.report.time_plot import TimePlot
from models.dataset.description import DatasetInfo


@dataclass(frozen=True)
class Card:
    """One of the numbers at the top."""

    value: str
    unit: str
    label: str
    note: str


@dataclass(frozen=True)
class Figure:
    """A figure: its ``data:`` address, what it shows for those who do not see it, and a note."""

    source: str
    alt: str
    note: str = ""


@dataclass(frozen=True)
class TitledTable:
    """A table with what it is of.

    Attributes
    ----------
    title : str
        For those who do not see it, and as its heading where ``heading`` is set.
    table : Table
    wide : bool
        Whether it needs all of the page.
    heading, folded : bool
        Whether the title stands above it, or hides it until it is asked for.
    prose : bool
        Whether its last column is sentences.
    """

    title: str
    table: Table
    wide: bool = False
    heading: bool = False
    folded: bool = False
    prose: bool = False


@dataclass(frozen=True)
class Section:
    """A section of the page; what is empty is left out.

    Attributes
    ----------
    title : str
    text : str
        Plain words before tables and figures.
    figures : tuple of Figure
    tables : tuple of TitledTable
    note : str
        Plain words after them, small.
    nothing : str
        Said instead where all tables are empty.
    """

    title: str
    text: str = ""
    figures: tuple[Figure, ...] = ()
    tables: tuple[TitledTable, ...] = ()
    note: str = ""
    nothing: str = ""

    @property
    def is_empty(self) -> bool:
        """Whether it has tables, and none has a row."""
        return bool(self.tables) and not any(each.table.rows for each in self.tables)


@dataclass(frozen=True, eq=False)
class ReportInput:
    """What a chain is given.

    Attributes
    ----------
    folder : Path
    info : DatasetInfo
    score : dict
        ``score.json``.
    label : str
        The pipeline that leads.
    records : FrameRecords
        With its estimates.
    scenario : dict
        Tables of the resolved scenario; empty where there is no truth half.
    """

    folder: Path
    info: DatasetInfo
    score: dict[str, Any]
    label: str
    records: FrameRecords
    scenario: dict[str, dict[str, Any]]

    @property
    def headline(self) -> dict[str, Any]:
        """The score of the pipeline that leads."""
        own: dict[str, Any] = self.score["pipelines"][self.label]
        return own


@dataclass(frozen=True)
class ReportParts:
    """What a chain gives.

    Attributes
    ----------
    lead : str
        What was seen: target, range, what was known.
    cards : list of Card
    hero : int
        The frame to draw large.
    hero_words : str
        Which frame that is.
    headline : Table
        All pipelines side by side.
    before : list of Section
        Between the picture and the headline table.
    after : list of Section
        Between it and the frames.
    later : list of Section
        Behind the frames.
    shown : list of int
        Frames that must be among those drawn.
    facts : dict of str to str
        More of what was run.
    plots : list of TimePlot
        Numbers against time, to be explored.
    """

    lead: str
    cards: list[Card]
    hero: int
    hero_words: str
    headline: Table
    before: list[Section] = field(default_factory=list)
    after: list[Section] = field(default_factory=list)
    later: list[Section] = field(default_factory=list)
    shown: list[int] = field(default_factory=list)
    facts: dict[str, str] = field(default_factory=dict)
    plots: list[TimePlot] = field(default_factory=list)
